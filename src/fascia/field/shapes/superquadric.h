#pragma once

#include <span>

#include <fascia/field/kernels.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/math/types.h>

namespace fascia {

// Barr's (1981) superellipsoid, shared by the shapes of its family:
//   (|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1) + |z/c|^(2/e1) = 1.
struct Superquadric {
  Vec3 half_m = Vec3::Ones();  // a, b, c
  double northSouth_e1 = 1;    // [0.1, 2]: 0.1 nearly flat ends, 1 round, 2 conical
  double eastWest_e2 = 1;  // [0.1, 2]: the cross-section: 0.1 nearly square, 1 round, 2 a diamond
};

// From a shape's parameters: half sizes, e1, e2.
inline Superquadric superquadricOf(std::span<const double> p) {
  return {Vec3(p[0], p[1], p[2]), p[3], p[4]};
}

double volume_m3(const Superquadric& s);
double gauge(const Superquadric& s, const Vec3& x);
// Gradient of the gauge; constant along rays. At the origin and on creases one of its limits.
Vec3 gaugeGradient(const Superquadric& s, const Vec3& x);
PrimitiveKernel kernel(const Superquadric& s);
TriangleMesh tessellate(const Superquadric& s, int detail);

}  // namespace fascia
