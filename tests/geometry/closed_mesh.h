#pragma once

#include <cmath>
#include <map>
#include <set>

#include <fascia/geometry/triangle_mesh.h>

namespace fascia::test {

// What a closed, 2-manifold, consistently oriented mesh has, counted.
struct ClosedMesh {
  bool closed = true;    // every edge runs once each way
  bool manifold = true;  // the triangles around every point are one fan
  long euler = 0;        // V − E + F: 2 per sphere, 0 per torus
  double shortest = 1e300, longest = 0, mean = 0;

  explicit ClosedMesh(const TriangleMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> along;
    std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> fan;  // corner: next → last
    std::set<std::uint32_t> points;
    for (const auto& t : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        ++along[{t[k], t[(k + 1) % 3]}];
        fan[t[k]][t[(k + 1) % 3]] = t[(k + 2) % 3];
        points.insert(t[k]);
      }
    for (const auto& [edge, times] : along) {
      closed = closed && times == 1 && along.contains({edge.second, edge.first});
      const double length =
          double{(mesh.positions[edge.first] - mesh.positions[edge.second]).norm()};
      shortest = std::min(shortest, length), longest = std::max(longest, length);
      mean += length / static_cast<double>(along.size());
    }
    for (const auto& [point, ring] : fan) {
      std::size_t steps = 0;
      std::uint32_t at = ring.begin()->first;
      do {
        const auto next = ring.find(at);
        if (next == ring.end()) break;
        at = next->second, ++steps;
      } while (at != ring.begin()->first && steps <= ring.size());
      manifold = manifold && steps == ring.size();
    }
    euler = static_cast<long>(points.size()) - static_cast<long>(along.size() / 2) +
            static_cast<long>(mesh.triangles.size());
  }
};

}  // namespace fascia::test
