#pragma once

#include <array>
#include <cstddef>

#include <fascia/base/aligned.h>

namespace fascia {

// What the SIMD kernels need to know of a primitive, as plain floats, prepared once per change of a
// parameter. All of them are convex, so that for every surface point q with normal n
//     distance(p) = max over q of n · (p − q)            (true on both sides of the surface).
// The kernels maximise over a few well-chosen q; therefore their estimate never exceeds the true
// signed distance: a penetration is never missed and a projected point never stays inside.
struct PrimitiveKernel {
  enum class Kind { sphere, capsule, ellipsoid, superellipsoid };
  Kind kind = Kind::sphere;
  float half_m[3] = {1, 1, 1};  // sphere, capsule: [0] is the radius
  float halfLength_m = 0;       // capsule: of its axis
  float northSouthPower = 2;    // 2 / e1 (Barr 1981), in [1, 20]
  float eastWestPower = 2;      // 2 / e2
  // From the above, for ellipsoids and superellipsoids:
  float square_m2[3] = {1, 1, 1}, inverse_per_m[3] = {1, 1, 1};
  float least_m = 1;                                 // half size
  float northSouthRoot = 0.5f, eastWestRoot = 0.5f;  // 1 / power
};

// One of Barr's (1984) deformations over the z interval [-zHalf_m, zHalf_m]; see deformations/.
struct DeformationKernel {
  enum class Kind { taper, twist, bend };
  Kind kind = Kind::taper;
  float zHalf_m = 1;
  float rate_per_m = 0;  // taper: slope of the scale; twist: rad/m; bend: curvature, rad/m
  float reach_m = 0;     // taper: |x| and |y| of the undeformed surface are at most this
};

inline constexpr std::size_t kMaxDeformations = 8;  // larger costs stack in the kernels only

struct SolidKernel {
  PrimitiveKernel primitive;
  std::array<DeformationKernel, kMaxDeformations> deformations;
  std::size_t deformationCount = 0;
};

// A rigid frame in floats, rows of the rotation first: world = rotation local + translation.
struct KernelFrame {
  float rotation[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  float translation_m[3] = {0, 0, 0};
};

// Signed distance estimate and outward unit normal of a framed solid at points, any count, any
// alignment; inputs and outputs may not overlap. Coordinates beyond 1e9 m count as 1e9 m.
void evaluateKernel(const SolidKernel& solid, const KernelFrame& frame, ConstVectors points,
                    float* distance_m, Vectors normal);

}  // namespace fascia
