#pragma once

#include <array>
#include <span>
#include <vector>

#include <fascia/flesh/posture_source.h>

namespace fascia {

// The joints of a skeleton that have all three rotations. Between postures they are turned as
// rotations: angles of two postures may lie on different sides of a whole turn, or of the pole.
class BallJoints {
 public:
  explicit BallJoints(const Skeleton& skeleton);

  std::size_t size() const { return joints_.size(); }
  JointId joint(std::size_t i) const { return joints_[i].joint; }
  // Indices of its rx, ry, rz in Posture::values.
  const std::array<std::size_t, 3>& values(std::size_t i) const { return joints_[i].values; }
  bool contains(std::size_t value) const { return ofBall_[value]; }

  // All of a posture's, by its rotation where it has one, else by its angles.
  void read(const Posture& posture, std::vector<JointRotation>& out) const;
  JointRotation read(std::size_t i, const Posture& posture) const;

 private:
  struct Joint {
    JointId joint;
    std::array<std::size_t, 3> values;
  };
  std::vector<Joint> joints_;
  std::vector<bool> ofBall_;  // per value
};

}  // namespace fascia
