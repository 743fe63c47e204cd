#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Geometry>

#include <fascia/math/types.h>
#include <fascia/pose/jiggle_state.h>

namespace fascia {

inline Vector4f wide(const Eigen::Vector3f& v) {
  return {v.x(), v.y(), v.z(), 0};
}
inline Eigen::Vector3f narrow(const Vector4f& v) {
  return v.head<3>();
}

// A rotation as its columns.
struct WideRotation {
  Vector4f column[3];

  Vector4f operator*(const Vector4f& v) const {
    return column[0] * v.x() + column[1] * v.y() + column[2] * v.z();
  }
  Vector4f back(const Vector4f& v) const {
    return {column[0].dot(v), column[1].dot(v), column[2].dot(v), 0};
  }
};

// Of a unit quaternion (x, y, z, w).
inline WideRotation rotationOf(const Vector4f& q) {
  const float x = q.x(), y = q.y(), z = q.z(), w = q.w();
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0},
           {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0},
           {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0}}};
}

// Where a joint takes the rest posture's space: rest -> now.
struct JointMotion {
  WideRotation rotation;
  Vector4f shift;
  Vector4f turn;  // the rotation as a quaternion (x, y, z, w)

  Vector4f point(const Vector4f& p) const { return rotation * p + shift; }
  Vector4f pointBack(const Vector4f& p) const { return rotation.back(p - shift); }
};

inline JointMotion jointMotion(const Transform& t) {
  const Quat q = Quat(t.rotation).normalized();
  JointMotion motion;
  for (int a = 0; a < 3; ++a) motion.rotation.column[a] << t.rotation.col(a).cast<float>(), 0.f;
  motion.shift << t.translation_m.cast<float>(), 0.f;
  motion.turn = q.coeffs().cast<float>();
  return motion;
}

// 3 t² - 2 t³ of t cut to [0, 1]: every gate of the pose function is made of these, so that its
// shape changes without corners as joints turn.
inline float smoothStep(float t) {
  t = std::clamp(t, 0.f, 1.f);
  return t * t * (3 - 2 * t);
}

}  // namespace fascia
