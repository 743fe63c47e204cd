#pragma once

#include <fascia/field/solid.h>

namespace fascia {

struct FieldSample {
  double distance_m = 0;
  Vec3 normal = Vec3::UnitX();
};

// What Solid::evaluate computes, one point at a time in double precision with plain formulas and
// the library's powers: the yardstick for the SIMD kernels.
FieldSample evaluateReference(const Solid& solid, const Vec3& local);

}  // namespace fascia
