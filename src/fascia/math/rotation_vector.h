#pragma once

#include <cmath>

#include <fascia/math/types.h>

namespace fascia {

// Rotations as vectors: axis times angle. Eade, "Lie Groups for 2D and 3D Transformations" (2013),
// sections 2 and 2.3: exp, log and the left Jacobian J of SO(3) with its inverse.

inline Quat rotationOf(const Vec3& vector_rad) {
  const double angle = vector_rad.norm();
  // sin(a/2) / a
  const double share = angle > 1e-6 ? std::sin(0.5 * angle) / angle : 0.5 - angle * angle / 48;
  const Vec3 imaginary = share * vector_rad;
  return Quat(std::cos(0.5 * angle), imaginary.x(), imaginary.y(), imaginary.z());
}

// The shorter way round: no longer than π.
inline Vec3 vectorOf(const Quat& rotation) {
  const double side = rotation.w() < 0 ? -1 : 1;
  const double sine = rotation.vec().norm(), cosine = side * rotation.w();
  const double share = sine > 1e-9 ? 2 * std::atan2(sine, cosine) / sine : 2 / cosine;
  return side * share * rotation.vec();
}

// The angular velocity of rotationOf(v) while v changes: J(v) v̇.
inline Vec3 angularVelocityOf(const Vec3& vector_rad, const Vec3& rate_rad_per_s) {
  const double angle2 = vector_rad.squaredNorm(), angle = std::sqrt(angle2);
  const bool small = angle < 1e-4;
  const double b = small ? 0.5 - angle2 / 24 : (1 - std::cos(angle)) / angle2;
  const double c = small ? 1.0 / 6 - angle2 / 120 : (angle - std::sin(angle)) / (angle2 * angle);
  const Vec3 turned = vector_rad.cross(rate_rad_per_s);
  return rate_rad_per_s + b * turned + c * vector_rad.cross(turned);
}

// The inverse: how v changes at an angular velocity. |v| < 2π.
inline Vec3 vectorRateOf(const Vec3& vector_rad, const Vec3& angular_rad_per_s) {
  const double angle2 = vector_rad.squaredNorm(), half = 0.5 * std::sqrt(angle2);
  const double d = half < 1e-3 ? 1.0 / 12 + angle2 / 720 : (1 - half / std::tan(half)) / angle2;
  const Vec3 turned = vector_rad.cross(angular_rad_per_s);
  return angular_rad_per_s - 0.5 * turned + d * vector_rad.cross(turned);
}

}  // namespace fascia
