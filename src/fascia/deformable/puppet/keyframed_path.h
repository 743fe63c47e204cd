#pragma once

#include <optional>
#include <span>
#include <vector>

#include <fascia/deformable/constraint/constraint.h>
#include <fascia/deformable/constraint/cubic_segment.h>

namespace fascia {

// Where a path is at one time. A velocity that is given for one side only goes for both; two that
// differ are a jump, which an impulse makes (Witkin & Welch 1990, §4.1).
struct PathKey {
  double time_s = 0;
  Vec3 position_m = Vec3::Zero();
  std::optional<Vec3> velocityIn_m_per_s, velocityOut_m_per_s;
};

// A piecewise cubic through keys. Velocities that are not given are those of the cubic spline with
// continuous acceleration between the given ones; at the ends the path rests.
class KeyframedPath {
 public:
  // Throws Error unless there are keys at growing times, of finite numbers.
  explicit KeyframedPath(std::vector<PathKey> keys);

  double start_s() const { return keys_.front().time_s; }
  double end_s() const { return keys_.back().time_s; }
  // All velocities are set.
  std::span<const PathKey> keys() const { return keys_; }

  // At a jump, after it. Before the start and after the end it goes on straight, with the velocity
  // into the first key and out of the last one.
  PathPoint at(double t_s) const;
  // If the velocity jumps at a time in (after_s, until_s].
  bool jumpsWithin(double after_s, double until_s) const;

 private:
  void check() const;
  void fillVelocities();
  void fillRun(std::size_t first, std::size_t last);

  std::vector<PathKey> keys_;
  std::vector<CubicSegment> segments_;  // keys_.size() − 1
};

}  // namespace fascia
