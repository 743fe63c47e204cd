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

}  // namespace fascia
