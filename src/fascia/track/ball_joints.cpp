#include <fascia/track/ball_joints.h>

#include <algorithm>

#include <fascia/skeleton/euler.h>

namespace fascia {

BallJoints::BallJoints(const Skeleton& skeleton) : ofBall_(skeleton.valueCount(), false) {
  for (std::size_t j = 0; j < skeleton.jointCount(); ++j) {
    const JointId id(j);
    const int x = skeleton.valueIndex(id, Dof::rx), y = skeleton.valueIndex(id, Dof::ry),
              z = skeleton.valueIndex(id, Dof::rz);
    if (x < 0 || y < 0 || z < 0) continue;
    joints_.push_back({id, {std::size_t(x), std::size_t(y), std::size_t(z)}});
    for (const std::size_t value : joints_.back().values) ofBall_[value] = true;
  }
}

void BallJoints::read(const Posture& posture, std::vector<JointRotation>& out) const {
  out.resize(joints_.size());
  for (std::size_t i = 0; i < joints_.size(); ++i) out[i] = read(i, posture);
}

JointRotation BallJoints::read(std::size_t i, const Posture& posture) const {
  const auto& [joint, values] = joints_[i];
  const auto given = std::ranges::lower_bound(posture.rotations, joint, {}, &JointRotation::joint);
  if (given != posture.rotations.end() && given->joint == joint) return *given;
  Vec3 angles, rates;
  for (int a = 0; a < 3; ++a) {
    angles[a] = posture.values[values[std::size_t(a)]];
    rates[a] = posture.rates[values[std::size_t(a)]];
  }
  return {joint, Quat(rotationZyx(angles)), angularVelocityZyx(angles, rates)};
}

}  // namespace fascia
