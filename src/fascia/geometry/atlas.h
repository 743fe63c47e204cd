#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// Texture coordinates for a closed mesh: it is cut into charts, each of which is seen from one of
// the six directions of the axes, at most about 70° askew, and no two triangles of which lie on
// each other. All charts have one scale. Vertices are cut apart between charts.
struct Atlas {
  std::vector<std::uint32_t> points;                    // per vertex: the mesh's
  std::vector<Eigen::Vector2f> uvs;                     // in [0, 1], (0,0) = top left
  std::vector<std::array<std::uint32_t, 3>> triangles;  // of vertices, in the mesh's order
  std::size_t charts = 0;
};
Atlas makeAtlas(const TriangleMesh& mesh);

}  // namespace fascia
