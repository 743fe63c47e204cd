#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/measure/best_rotation.h>
#include <fascia/measure/deformation.h>
#include <fascia/measure/percentile.h>

namespace fascia {
RestDetail::RestDetail(TriangleList triangles, PointList rest)
    : rest_(rest.begin(), rest.end()), edge_m_(rest.size(), 0) {
  computeNormals(rest_, {triangles.begin(), triangles.end()}, normal_);
  const std::vector<std::array<std::uint32_t, 2>> edges = edgesBothWays(triangles);
  first_.assign(1, 0);
  auto it = edges.begin();
  for (std::uint32_t p = 0; p < rest.size(); ++p) {
    bool open = false;
    double length_m = 0;
    while (it != edges.end() && (*it)[0] == p) {
      const auto next = std::upper_bound(it, edges.end(), *it);
      open = open || next - it == 1;
      neighbour_.push_back((*it)[1]);
      length_m += static_cast<double>((rest_[p] - rest_[(*it)[1]]).norm());
      it = next;
    }
    const std::size_t count = neighbour_.size() - first_.back();
    first_.push_back(static_cast<std::uint32_t>(neighbour_.size()));
    if (!open && count >= 3) edge_m_[p] = length_m / static_cast<double>(count);
  }
}

double RestDetail::change(std::size_t point, PointList points) const {
  FASCIA_ASSERT(point < points.size(), "the point exists");
  const Vec3 restHere = rest_[point].cast<double>(), here = points[point].cast<double>();
  Mat3 ring = Mat3::Zero();
  Vec3 restSum = Vec3::Zero(), sum = Vec3::Zero();
  for (std::uint32_t n = first_[point]; n < first_[point + 1]; ++n) {
    const Vec3 restEdge = rest_[neighbour_[n]].cast<double>() - restHere;
    const Vec3 edge = points[neighbour_[n]].cast<double>() - here;
    ring += edge * restEdge.transpose();
    restSum += restEdge;
    sum += edge;
  }
  const auto count = static_cast<double>(first_[point + 1] - first_[point]);
  const Vec3 detail = -restSum / count, detailNow = -sum / count;
  const Vec3 moved = bestRotation(ring).transpose() * detailNow - detail;
  return std::abs(moved.dot(normal_[point].cast<double>())) / edge_m_[point];
}

Lumpiness lumpiness(const RestDetail& detail, std::span<const std::uint32_t> which,
                    PointList points) {
  std::vector<double> changes;
  double squares = 0;
  for (const std::uint32_t p : which) {
    if (!detail.has(p)) continue;
    const double change = detail.change(p, points);
    changes.push_back(std::isfinite(change) ? change : HUGE_VAL);
    squares += changes.back() * changes.back();
  }
  if (changes.empty()) return {};
  return {std::sqrt(squares / static_cast<double>(changes.size())), percentile(changes, 0.99)};
}

}  // namespace fascia
