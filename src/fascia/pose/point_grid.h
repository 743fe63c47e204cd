#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace fascia {

// Points by the cube that they lie in, sorted: what lies within a cube's edge of a place is in the
// 27 cubes around it.
class PointGrid {
 public:
  PointGrid(const std::vector<Eigen::Vector3f>& points, float cell_m) : cell_m_(cell_m) {
    for (std::uint32_t i = 0; i < points.size(); ++i) entries_.push_back({keyOf(points[i]), i});
    std::sort(entries_.begin(), entries_.end());
  }

  template <class Visit>
  void visitNear(const Eigen::Vector3f& p, const Visit& visit) const {
    const Key middle = keyOf(p);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y) {
        // Cells that differ in z only follow each other.
        const Key low{middle[0] + x, middle[1] + y, middle[2] - 1};
        const Key high{middle[0] + x, middle[1] + y, middle[2] + 2};
        auto e = std::lower_bound(entries_.begin(), entries_.end(), Entry{low, 0});
        for (; e != entries_.end() && e->first < high; ++e) visit(e->second);
      }
  }

 private:
  using Key = std::array<int, 3>;
  using Entry = std::pair<Key, std::uint32_t>;
  Key keyOf(const Eigen::Vector3f& p) const {
    Key key;
    for (int a = 0; a < 3; ++a)
      key[static_cast<std::size_t>(a)] = static_cast<int>(std::floor(p[a] / cell_m_));
    return key;
  }

  float cell_m_;
  std::vector<Entry> entries_;
};

}  // namespace fascia
