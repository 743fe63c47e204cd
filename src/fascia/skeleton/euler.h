#pragma once

#include <cmath>

#include <fascia/math/types.h>

namespace fascia {

// Rz·Ry·Rx from the angles about x, y and z: the order of every orientation in a character file.
inline Mat3 rotationZyx(const Vec3& angles_rad) {
  const double cx = std::cos(angles_rad.x()), sx = std::sin(angles_rad.x());
  const double cy = std::cos(angles_rad.y()), sy = std::sin(angles_rad.y());
  const double cz = std::cos(angles_rad.z()), sz = std::sin(angles_rad.z());
  Mat3 r;
  r << cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx,  //
      sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx,   //
      -sy, cy * sx, cy * cx;
  return r;
}

// Angular velocity of that rotation, in the frame it turns in: each rate turns about its own axis,
// carried by the rotations to its left: ω = ż e_z + Rz (ẏ e_y) + Rz Ry (ẋ e_x).
inline Vec3 angularVelocityZyx(const Vec3& angles_rad, const Vec3& rates_rad_per_s) {
  const double cy = std::cos(angles_rad.y()), sy = std::sin(angles_rad.y());
  const double cz = std::cos(angles_rad.z()), sz = std::sin(angles_rad.z());
  const double x = rates_rad_per_s.x(), y = rates_rad_per_s.y(), z = rates_rad_per_s.z();
  return {-sz * y + cz * cy * x, cz * y + sz * cy * x, z - sy * x};
}

// The angles of a rotation, |y| ≤ 90°.
inline Vec3 anglesZyx(const Mat3& r) {
  const double cosine = std::hypot(r(0, 0), r(1, 0));
  const double y = std::atan2(-r(2, 0), cosine);
  if (cosine < 1e-9) return {std::atan2(-r(1, 2), r(1, 1)), y, 0};  // x and z turn alike there
  return {std::atan2(r(2, 1), r(2, 2)), y, std::atan2(r(1, 0), r(0, 0))};
}

// The angles of a rotation that are nearest to others. Two triples and their whole turns give the
// same rotation; at y = ±90° it is x ∓ z alone that counts, and both share what is to be made up.
inline Vec3 anglesZyxNear(const Mat3& r, const Vec3& near_rad) {
  const auto close = [](double angle, double near) {
    return near + std::remainder(angle - near, 2 * kPi);
  };
  const double cosine = std::hypot(r(0, 0), r(1, 0));
  const double y = std::atan2(-r(2, 0), cosine);
  if (cosine < 1e-9) {
    const double side = y > 0 ? 1 : -1;
    const double both = std::atan2(side * r(0, 1), r(1, 1));  // x − side z
    const double change = std::remainder(both - (near_rad.x() - side * near_rad.z()), 2 * kPi);
    return {near_rad.x() + 0.5 * change, close(y, near_rad.y()),
            near_rad.z() - 0.5 * side * change};
  }
  const double x = std::atan2(r(2, 1), r(2, 2)), z = std::atan2(r(1, 0), r(0, 0));
  const Vec3 plain{close(x, near_rad.x()), close(y, near_rad.y()), close(z, near_rad.z())};
  const Vec3 over{close(x + kPi, near_rad.x()), close(kPi - y, near_rad.y()),
                  close(z + kPi, near_rad.z())};
  return (over - near_rad).squaredNorm() < (plain - near_rad).squaredNorm() ? over : plain;
}

// The rates of these angles at an angular velocity, the inverse of the above; where the angles lose
// a direction (y = ±90°) the best that finite rates can do.
inline Vec3 angleRatesZyx(const Vec3& angles_rad, const Vec3& angular_rad_per_s) {
  Mat3 axes;
  for (int a = 0; a < 3; ++a) axes.col(a) = angularVelocityZyx(angles_rad, Vec3::Unit(a));
  const Mat3 damped = axes * axes.transpose() + 1e-6 * Mat3::Identity();
  return axes.transpose() * damped.inverse() * angular_rad_per_s;
}

}  // namespace fascia
