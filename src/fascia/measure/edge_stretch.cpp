#include <algorithm>
#include <cmath>

#include <fascia/measure/deformation.h>

namespace fascia {
namespace {

using Edge = std::array<std::uint32_t, 2>;

std::vector<Edge> edgesOf(TriangleList triangles) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b)});
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

double length(PointList points, const Edge& edge) {
  return (points[edge[0]].cast<double>() - points[edge[1]].cast<double>()).norm();
}

}  // namespace

EdgeStretch edgeStretch(TriangleList triangles, PointList rest, PointList points) {
  std::vector<double> stretch;
  for (const Edge& edge : edgesOf(triangles)) {
    const double restLength = length(rest, edge);
    if (!(restLength > 0)) continue;
    const double ratio = length(points, edge) / restLength;
    stretch.push_back(std::isfinite(ratio) ? ratio : HUGE_VAL);
  }
  if (stretch.empty()) return {};
  // The nearest rank: at least 99 % of all edges are no longer than this one.
  const auto rank = static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(stretch.size())));
  const auto nth = stretch.begin() + static_cast<std::ptrdiff_t>(rank - 1);
  std::nth_element(stretch.begin(), nth, stretch.end());
  return {*std::max_element(nth, stretch.end()), *nth};
}

}  // namespace fascia
