#pragma once

#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// Divides every triangle in four until there are at least `triangles`, with the new points on
// curved patches through the old ones: coarse grids get round outlines. Points after Vlachos et
// al., "Curved PN Triangles" (2001), at the middles of the edges; normals are means, because their
// quadratic ones ripple along the diagonals of a grid. The result's topology depends on the input's
// only. Needs normals.
TriangleMesh smoothed(const TriangleMesh& mesh, std::size_t triangles);

}  // namespace fascia
