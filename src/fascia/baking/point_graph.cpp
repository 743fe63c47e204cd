#include <fascia/baking/point_graph.h>

#include <algorithm>

#include <fascia/base/assert.h>

namespace fascia {

PointGraph::PointGraph(std::size_t pointCount,
                       std::span<const std::array<std::uint32_t, 3>> triangles)
    : start_(pointCount + 1, 0) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  edges.reserve(6 * triangles.size());
  for (const std::array<std::uint32_t, 3>& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (a == b) continue;
      edges.push_back({a, b});
      edges.push_back({b, a});
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  neighbor_.reserve(edges.size());
  for (const std::array<std::uint32_t, 2>& edge : edges) {
    ++start_[edge[0] + 1];
    neighbor_.push_back(edge[1]);
  }
  for (std::size_t i = 0; i < pointCount; ++i) start_[i + 1] += start_[i];
}

void smoothOnGraph(const PointGraph& graph, int passes, std::vector<double>& values) {
  FASCIA_ASSERT(passes >= 0, "passes are counted");
  std::vector<double> before;
  for (int pass = 0; pass < passes; ++pass) {
    before = values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::span<const std::uint32_t> around = graph.neighbors(i);
      if (around.empty()) continue;
      double sum = 0;
      for (const std::uint32_t j : around) sum += before[j];
      values[i] = 0.5 * (before[i] + sum / static_cast<double>(around.size()));
    }
  }
}

std::vector<std::uint32_t> patchAround(const PointGraph& graph, std::uint32_t seed,
                                       std::size_t count) {
  std::vector<std::uint32_t> patch{seed};
  std::vector<bool> seen(graph.pointCount(), false);
  seen[seed] = true;
  for (std::size_t next = 0; next < patch.size() && patch.size() < count; ++next) {
    for (const std::uint32_t j : graph.neighbors(patch[next])) {
      if (seen[j] || patch.size() >= count) continue;
      seen[j] = true;
      patch.push_back(j);
    }
  }
  return patch;
}

}  // namespace fascia
