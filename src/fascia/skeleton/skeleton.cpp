#include <fascia/skeleton/skeleton.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <fascia/skeleton/euler.h>
#include <fascia/skeleton/skeleton_validation.h>

namespace fascia {
namespace {

constexpr std::array<std::string_view, 6> kDofNames = {"tx", "ty", "tz", "rx", "ry", "rz"};

}  // namespace

std::string_view name(Dof dof) {
  return kDofNames[static_cast<std::size_t>(dof)];
}

std::optional<Dof> dofFromName(std::string_view text) {
  for (std::size_t i = 0; i < kDofNames.size(); ++i) {
    if (kDofNames[i] == text) return static_cast<Dof>(i);
  }
  return std::nullopt;
}

Skeleton::Skeleton(const SkeletonDef& def, const std::string& pointer, Diagnostics& diagnostics) {
  const std::size_t errorsBefore = diagnostics.errors().size();
  validateSkeleton(def, pointer, diagnostics);
  if (diagnostics.errors().size() > errorsBefore) return;

  for (const JointDef& joint : def.joints) {
    parents_.push_back(joint.parent.empty() ? JointId{} : find(joint.parent));
    const JointId id{static_cast<std::int64_t>(joints_.size())};
    joints_.push_back(joint);
    restFrames_.push_back({rotationZyx(joint.orientation_rad), joint.offset_m});
    firstValue_.push_back(static_cast<int>(valueDofs_.size()));
    for (const DofDef& dof : joint.dofs) {
      valueDofs_.push_back(dof);
      valueJoints_.push_back(id);
    }
  }
  firstValue_.push_back(static_cast<int>(valueDofs_.size()));
}

JointId Skeleton::find(std::string_view name) const {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (joints_[i].name == name) return JointId{static_cast<std::int64_t>(i)};
  }
  return {};
}

int Skeleton::valueIndex(JointId joint, Dof dof) const {
  for (int i = firstValue_[joint.index()]; i < firstValue_[joint.index() + 1]; ++i) {
    if (valueDof(i).dof == dof) return i;
  }
  return -1;
}

Posture Skeleton::restPosture() const {
  Posture posture;
  for (const DofDef& dof : valueDofs_) posture.values.push_back(dof.rest);
  posture.rates.assign(valueCount(), 0.0);
  return posture;
}

void Skeleton::clampToLimits(Posture& posture) const {
  for (std::size_t i = 0; i < valueDofs_.size(); ++i) {
    const DofDef& dof = valueDofs_[i];
    double& value = posture.values[i];
    const double allowed = std::isnan(value) ? dof.rest : std::clamp(value, dof.min, dof.max);
    if (value == allowed && std::isfinite(posture.rates[i])) continue;
    value = allowed;
    posture.rates[i] = 0;
  }
}

struct Skeleton::Local {
  Vec3 position_m = Vec3::Zero(), angles_rad = Vec3::Zero();
  Vec3 linear_m_per_s = Vec3::Zero(), angleRates_rad_per_s = Vec3::Zero();
};

Skeleton::Local Skeleton::local(std::size_t joint, const Posture& posture) const {
  Local local;
  for (int i = firstValue_[joint]; i < firstValue_[joint + 1]; ++i) {
    const auto value = static_cast<std::size_t>(i);
    const Dof dof = valueDofs_[value].dof;
    const bool turns = isRotation(dof);
    const int axis = static_cast<int>(dof) - static_cast<int>(turns ? Dof::rx : Dof::tx);
    (turns ? local.angles_rad : local.position_m)[axis] = posture.values[value];
    (turns ? local.angleRates_rad_per_s : local.linear_m_per_s)[axis] = posture.rates[value];
  }
  return local;
}

void Skeleton::pose(const Posture& posture, PosedSkeleton& out) const {
  out.joint_world.resize(joints_.size());
  out.twist_world.resize(joints_.size());
  auto turn = posture.rotations.begin();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    Transform base = restFrames_[i];  // where the joint would be at zero
    Twist carried;                    // what the parent's motion does to it
    if (parents_[i].valid()) {
      base = out.joint_world[parents_[i].index()] * base;
      carried = out.twist_world[parents_[i].index()];
    }
    const Local own = local(i, posture);
    const Vec3 origin_m = base.point(own.position_m);
    const bool turned = turn != posture.rotations.end() && turn->joint.index() == i;
    const Mat3 rotation = turned ? turn->rotation.toRotationMatrix() : rotationZyx(own.angles_rad);
    const Vec3 spin_rad_per_s = turned
                                    ? turn->angular_rad_per_s
                                    : angularVelocityZyx(own.angles_rad, own.angleRates_rad_per_s);
    if (turned) ++turn;
    out.joint_world[i] = {base.rotation * rotation, origin_m};
    out.twist_world[i] = {carried.at(origin_m) + base.vector(own.linear_m_per_s),
                          carried.angular_rad_per_s + base.vector(spin_rad_per_s), origin_m};
  }
}

}  // namespace fascia
