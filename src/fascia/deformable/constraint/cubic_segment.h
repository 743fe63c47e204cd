#pragma once

#include <fascia/deformable/constraint/constraint.h>

namespace fascia {

// A cubic (Hermite) that takes a point from a place and velocity to others (Witkin & Welch 1990,
// §4.2). Before its start and after its end it goes on straight with the velocity it has there, so
// that a step that reaches over an end sees a smooth path. It owns no memory:
// it may be planned anew in every step.
class CubicSegment {
 public:
  CubicSegment() = default;
  // end_s > start_s.
  CubicSegment(double start_s, const Vec3& startPosition_m, const Vec3& startVelocity_m_per_s,
               double end_s, const Vec3& endPosition_m, const Vec3& endVelocity_m_per_s)
      : start_s_(start_s),
        end_s_(end_s),
        startPosition_m_(startPosition_m),
        startVelocity_m_per_s_(startVelocity_m_per_s),
        endPosition_m_(endPosition_m),
        endVelocity_m_per_s_(endVelocity_m_per_s) {
    const double T = end_s - start_s;
    const Vec3 mean = (endPosition_m - startPosition_m) / T;
    quadratic_ = (3 * mean - 2 * startVelocity_m_per_s - endVelocity_m_per_s) / T;
    cubic_ = (startVelocity_m_per_s + endVelocity_m_per_s - 2 * mean) / (T * T);
  }

  double start_s() const { return start_s_; }
  double end_s() const { return end_s_; }

  PathPoint at(double t_s) const {
    if (t_s < start_s_) return straight(t_s - start_s_, startPosition_m_, startVelocity_m_per_s_);
    if (t_s >= end_s_) return straight(t_s - end_s_, endPosition_m_, endVelocity_m_per_s_);
    const double u = t_s - start_s_;
    return {startPosition_m_ + u * (startVelocity_m_per_s_ + u * (quadratic_ + u * cubic_)),
            startVelocity_m_per_s_ + u * (2 * quadratic_ + 3 * u * cubic_),
            2 * quadratic_ + 6 * u * cubic_};
  }

 private:
  static PathPoint straight(double u_s, const Vec3& place_m, const Vec3& velocity_m_per_s) {
    return {place_m + u_s * velocity_m_per_s, velocity_m_per_s, Vec3::Zero()};
  }

  double start_s_ = 0, end_s_ = 1;
  Vec3 startPosition_m_ = Vec3::Zero(), startVelocity_m_per_s_ = Vec3::Zero();
  Vec3 endPosition_m_ = Vec3::Zero(), endVelocity_m_per_s_ = Vec3::Zero();
  Vec3 quadratic_ = Vec3::Zero(), cubic_ = Vec3::Zero();
};

}  // namespace fascia
