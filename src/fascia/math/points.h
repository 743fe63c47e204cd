#pragma once

#include <fascia/base/aligned.h>
#include <fascia/base/assert.h>
#include <fascia/math/types.h>

namespace fascia {

// One vector of a structure of arrays.

inline Vec3 pointAt(ConstVectors a, std::size_t i) {
  FASCIA_ASSERT(i < a.count, "the point exists");
  return {a.x[i], a.y[i], a.z[i]};
}
inline Vec3 pointAt(const VectorArray& a, std::size_t i) {
  FASCIA_ASSERT(i < a.size(), "the point exists");
  return {a.x[i], a.y[i], a.z[i]};
}
inline Eigen::Vector3f floatPointAt(const VectorArray& a, std::size_t i) {
  FASCIA_ASSERT(i < a.size(), "the point exists");
  return {a.x[i], a.y[i], a.z[i]};
}

// Rounds to float.
inline void setPoint(Vectors a, std::size_t i, const Vec3& p) {
  FASCIA_ASSERT(i < a.count, "the point exists");
  a.x[i] = static_cast<float>(p.x());
  a.y[i] = static_cast<float>(p.y());
  a.z[i] = static_cast<float>(p.z());
}
inline void setPoint(VectorArray& a, std::size_t i, const Vec3& p) {
  setPoint(view(a, 0, a.size()), i, p);
}

}  // namespace fascia
