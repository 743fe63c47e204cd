#include <algorithm>
#include <array>
#include <cassert>

#include <fascia/skeleton/euler.h>
#include <fascia/skeleton/skeleton.h>

namespace fascia {
namespace {

// Of a quaternion that is to be made unit: anything shorter is no direction.
constexpr double kShortestQuaternion = 1e-9;

constexpr std::array<Dof, 3> kAngles = {Dof::rx, Dof::ry, Dof::rz};

bool finite(const JointRotation& turn) {
  return turn.rotation.coeffs().allFinite() && turn.angular_rad_per_s.allFinite() &&
         turn.rotation.norm() > kShortestQuaternion;
}

}  // namespace

// Whether the rotation is to be kept beside the angles.
bool Skeleton::resolveRotation(const JointRotation& turn, std::span<const double> near,
                               Posture& posture) const {
  std::array<int, 3> index;
  Vec3 close_rad = Vec3::Zero();
  for (std::size_t a = 0; a < 3; ++a) {
    index[a] = valueIndex(turn.joint, kAngles[a]);
    if (index[a] < 0) continue;
    const double former = near.empty() ? valueDof(index[a]).rest : near[std::size_t(index[a])];
    close_rad[static_cast<int>(a)] = former;
  }
  const auto allowed = [&](const Vec3& angles_rad) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (index[a] < 0) continue;
      const DofDef& dof = valueDof(index[a]);
      const double angle = angles_rad[static_cast<int>(a)];
      if (angle < dof.min || angle > dof.max) return false;
    }
    return true;
  };
  const Mat3 rotation = turn.rotation.toRotationMatrix();
  Vec3 angles_rad = anglesZyxNear(rotation, close_rad);
  if (!allowed(angles_rad) && allowed(anglesZyx(rotation))) angles_rad = anglesZyx(rotation);
  const Vec3 rates = angleRatesZyx(angles_rad, turn.angular_rad_per_s);
  for (std::size_t a = 0; a < 3; ++a) {
    if (index[a] < 0) continue;
    posture.values[static_cast<std::size_t>(index[a])] = angles_rad[static_cast<int>(a)];
    posture.rates[static_cast<std::size_t>(index[a])] = rates[static_cast<int>(a)];
  }
  return std::ranges::min(index) >= 0 && allowed(angles_rad);
}

void Skeleton::resolveRotations(std::span<const double> near, Posture& posture) const {
  std::vector<JointRotation>& turns = posture.rotations;
  if (turns.empty()) return;
  assert(near.empty() || near.size() == valueCount());
  std::erase_if(turns, [&](const JointRotation& turn) {
    return !turn.joint.valid() || turn.joint.index() >= jointCount() || !finite(turn);
  });
  std::ranges::sort(turns, {}, &JointRotation::joint);
  const auto sameJoint = [](const JointRotation& a, const JointRotation& b) {
    return a.joint == b.joint;
  };
  turns.erase(std::unique(turns.begin(), turns.end(), sameJoint), turns.end());
  std::erase_if(turns, [&](JointRotation& turn) {
    turn.rotation.normalize();
    return !resolveRotation(turn, near, posture);
  });
}

}  // namespace fascia
