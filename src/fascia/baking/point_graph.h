#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace fascia {

// Which points share an edge.
class PointGraph {
 public:
  PointGraph(std::size_t pointCount, std::span<const std::array<std::uint32_t, 3>> triangles);

  std::size_t pointCount() const { return start_.size() - 1; }
  std::span<const std::uint32_t> neighbors(std::size_t point) const {  // increasing
    return {neighbor_.data() + start_[point], start_[point + 1] - start_[point]};
  }

 private:
  std::vector<std::size_t> start_;  // pointCount + 1
  std::vector<std::uint32_t> neighbor_;
};

// Each value replaced by the mean of itself and its neighbours' mean, `passes` times.
void smoothOnGraph(const PointGraph& graph, int passes, std::vector<double>& values);

// The points nearest to `seed` in steps along edges, at most `count`, the seed first.
std::vector<std::uint32_t> patchAround(const PointGraph& graph, std::uint32_t seed,
                                       std::size_t count);

}  // namespace fascia
