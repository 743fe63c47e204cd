#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace fascia {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double radians(double degrees) {
  return degrees * (kPi / 180.0);
}
inline constexpr double degrees(double radians) {
  return radians * (180.0 / kPi);
}

// A rigid motion: p ↦ rotation p + translation_m.
struct Transform {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation_m = Vec3::Zero();

  Vec3 point(const Vec3& p) const { return rotation * p + translation_m; }
  Vec3 vector(const Vec3& v) const { return rotation * v; }
  Transform operator*(const Transform& b) const {
    return {rotation * b.rotation, rotation * b.translation_m + translation_m};
  }
  Transform inverse() const {
    return {rotation.transpose(), -(rotation.transpose() * translation_m)};
  }
  bool operator==(const Transform&) const = default;
};

// Velocity of a rigid body: of its origin's point, and about it.
struct Twist {
  Vec3 linear_m_per_s = Vec3::Zero();
  Vec3 angular_rad_per_s = Vec3::Zero();
  Vec3 origin_m = Vec3::Zero();  // the point that `linear` is the velocity of

  Vec3 at(const Vec3& p) const { return linear_m_per_s + angular_rad_per_s.cross(p - origin_m); }
};

struct Box {
  Vec3 low = Vec3::Constant(1e300);
  Vec3 high = Vec3::Constant(-1e300);

  void add(const Vec3& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); }
  void add(const Box& b) { low = low.cwiseMin(b.low), high = high.cwiseMax(b.high); }
  bool empty() const { return (low.array() > high.array()).any(); }
  Vec3 center() const { return 0.5 * (low + high); }
  Vec3 size() const { return high - low; }
};

}  // namespace fascia
