#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/skin/mesh/triangle_membrane.h>

namespace fascia {

// How a triangle mesh lies in memory for the kernels, fixed when a skin is built.
//
// Points keep their storage order for everything that is one float per point, but their positions
// are also kept as blocks of four floats, so that a triangle's corner is one 128-bit load: hardware
// gathers take a cycle and a half per float. Triangles run in batches; each writes the forces on
// its corners to a place of its own, and each point sums the places of its corners. No two
// triangles write the same place, so no colouring is needed, and sums do not depend on threads.
//
// A chunk is a range of points with all triangles that touch it: small enough for the cache, and
// independent of the others within a step. Triangles across a border are computed in both chunks.
struct MeshLayout {
  static constexpr std::size_t kBatch = 16;  // elements or points; the widest vector
  static constexpr std::size_t kQuad = 4;    // floats per position or force
  // Floats before the first corner force in scratch; the first four are the zero of missing
  // corners.
  static constexpr std::size_t kScratchHead = 16;

  struct Range {
    std::uint32_t first = 0, count = 0;
  };
  struct Chunk {
    Range points;             // multiples of kBatch
    Range triangles, hinges;  // in batches
  };
  // Triangles or hinges in batches.
  struct Elements {
    std::vector<std::uint32_t> corners;  // per batch, corner and element: offset of its quad
    FloatArray coefficients;             // per batch, coefficient and element
  };

  std::vector<Chunk> chunks;
  Elements triangles;  // coefficients u[0], u[1], v[0], v[1], stretch_u / 2, stretch_v / 2, shear
  Elements hinges;     // stiffness, restCosine, restSine, floor1, floor2, floorEdge
  static constexpr std::size_t kTriangleCorners = 3, kTriangleFloats = 7;
  static constexpr std::size_t kHingeCorners = 4, kHingeFloats = 6;
  // Per slice of kBatch points: where in `places` it begins, one more at the end. A slice has for
  // each of its points the same number of offsets into scratch.
  std::vector<std::uint32_t> sliceFirst, places;
  std::size_t lanes = 1;          // of the vectors that will run over this layout: 1, 4, 8 or 16
  std::size_t pointCount = 0;     // multiple of kBatch
  std::size_t scratchFloats = 0;  // that any chunk needs
  float cap = 1;

  MeshLayout() = default;
  MeshLayout(const TriangleMembrane& membrane, std::size_t lanes);

  // Quads are written and read four vectors at a time and transposed within 128 bits: lane 4b+k of
  // a vector of points is 128-bit block b of the k-th of four vectors in memory.
  std::size_t quadOffset(std::size_t item) const {
    const std::size_t lane = item % lanes;
    return item / lanes * lanes * kQuad + lane % kQuad * lanes + lane / kQuad * kQuad;
  }
};

}  // namespace fascia
