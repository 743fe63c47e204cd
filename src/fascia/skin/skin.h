#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/field/field.h>
#include <fascia/flesh/flesh.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/skin/skin_def.h>

namespace fascia {

// Under construction: the skin model, its state and its stage function.
struct SkinStats {
  std::uint64_t steps = 0, rejected_steps = 0;
  double step_min_s = 1e300, step_max_s = 0;
  double forces_s = 0, constraints_s = 0, other_s = 0;  // wall clock spent
  double max_penetration_m = 0;  // over all frames, after the step
  double max_edge_stretch = 0;   // length over rest length
  std::uint64_t repaired_points = 0;  // points that had to be put back (see never-explodes)
};

struct SkinState {
  VectorArray position, velocity;  // world, metres and m/s; pointCount entries (without padding)
};
struct SkinWorkspace {};

class Skin {
 public:
  int columns() const { return 0; }
  int rows() const { return 0; }
  std::size_t pointCount() const { return 0; }  // columns x rows; point (i, j) = j * columns + i
};

// The surface of a state for display and export: closed tube with its two ends capped. Vertex order
// and triangles are the same for every frame: first the columns x rows points with a seam column
// repeated for its uv (columns + 1 per row), then two cap centres.
void skinSurface(const Skin& skin, const SkinState& state, TriangleMesh& mesh);

}  // namespace fascia
