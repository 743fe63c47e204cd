#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/skin/grid/grid_layout.h>

namespace fascia {

// The two triangles of each cell, cell by cell; corners are storage indices.
std::vector<std::array<std::uint32_t, 3>> cellTriangles(const GridLayout& g);

// The same with a fan over each of the tube's ends. Vertices are storage indices, and the two
// centres.
TriangleMesh closedTube(const GridLayout& g, const VectorArray& r);

}  // namespace fascia
