#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/measure/deformation.h>
#include <fascia/measure/percentile.h>

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
  FASCIA_ASSERT(areBelow(edge, points.size()), "an edge joins points");
  return (points[edge[0]].cast<double>() - points[edge[1]].cast<double>()).norm();
}

}  // namespace

EdgeStretch edgeStretch(TriangleList triangles, PointList rest, PointList points) {
  FASCIA_ASSERT(rest.size() == points.size(), "the surface keeps its points");
  std::vector<double> stretch;
  for (const Edge& edge : edgesOf(triangles)) {
    const double restLength = length(rest, edge);
    if (!(restLength > 0)) continue;
    const double ratio = length(points, edge) / restLength;
    stretch.push_back(std::isfinite(ratio) ? ratio : HUGE_VAL);
  }
  if (stretch.empty()) return {};
  const double largest = *std::max_element(stretch.begin(), stretch.end());
  return {largest, percentile(stretch, 0.99)};
}

}  // namespace fascia
