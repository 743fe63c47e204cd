#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// The connected pieces of a mesh whose triangles are counter-clockwise seen from inside, as if they
// had been turned inside out: their numbers, increasing. `component`: per vertex, below `count`.
//
// A piece says what its outside is if it encloses a volume; small holes do not matter, sheets and
// bowls are left alone. What lies inside of another piece (the lining of a coat, the wall of a
// cavity) is as it is meant to be against that one: it goes with it. Pieces of less than 1 % of
// the surface, and of meshes with too many nested pieces to tell, are left alone.
std::vector<std::uint32_t> insideOutPieces(const TriangleMesh& mesh,
                                           std::span<const std::uint32_t> component,
                                           std::uint32_t count);

}  // namespace fascia
