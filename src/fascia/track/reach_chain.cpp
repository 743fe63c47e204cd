#include <fascia/track/reach_chain.h>

#include <algorithm>
#include <cmath>

#include <fascia/math/rotation_vector.h>
#include <fascia/skeleton/euler.h>

namespace fascia {
namespace {

using Mat6 = Eigen::Matrix<double, 6, 6>;

constexpr int kMostSteps = 60;
// Residuals in lengths of the chain and radians: below what double can hold of a character.
constexpr double kReached = 1e-13;
// The damping that is left at the goal. Larger slows the last steps, smaller lets a stretched limb
// swing; the paper takes 1e-3 to 1e-2 of the squared length.
constexpr double kBias = 1e-5;
// Limits that stop a value are found one after the other.
constexpr int kMostHeld = 4;
// A goal that is missed by more is tried for a second time, and that is taken if it is so much
// better: a limb that only stretches for its goal must not change its mind from frame to frame.
constexpr double kNear = 1e-6;
constexpr double kWorthIt = 0.5;

}  // namespace

struct ReachChain::Wanted {
  Vec3 position_m;
  std::optional<Quat> orientation;
  Transform base;  // of the root's parent
};

ReachChain::ReachChain(const Skeleton& skeleton, const ReachChainDef& def) : point_m_(def.point_m) {
  JointId id = def.end;
  for (; id.valid(); id = skeleton.parent(id)) {
    const JointDef& joint = skeleton.joint(id);
    Joint own{id, {rotationZyx(joint.orientation_rad), joint.offset_m}, {}};
    for (int d = 0; d < 6; ++d) own.values[d] = skeleton.valueIndex(id, static_cast<Dof>(d));
    joints_.push_back(own);
    if (id == def.root) break;
  }
  if (!id.valid()) return;  // the root is not above the end
  parent_ = skeleton.parent(def.root);
  std::ranges::reverse(joints_);
  length_m_ = point_m_.norm();
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (j > 0) length_m_ += joints_[j].rest.translation_m.norm();
    for (int axis = 0; axis < 3; ++axis) {
      const int value = joints_[j].values[3 + axis];
      if (value < 0) continue;
      const DofDef& dof = skeleton.valueDof(value);
      turns_.push_back({j, axis, static_cast<std::size_t>(value), dof.min, dof.max});
    }
  }
  length_m_ = std::max(length_m_, 1e-6);
  frames_.resize(joints_.size());
  axes_.resize(turns_.size());
  held_.resize(turns_.size());
  change_.resize(turns_.size());
  columns_.resize(turns_.size());
  first_.resize(turns_.size());
}

bool ReachChain::contains(JointId joint) const {
  return std::ranges::any_of(joints_, [&](const Joint& j) { return j.id == joint; });
}

// Where the joints are, and the axes.
void ReachChain::follow(const Posture& posture, const Transform& base) const {
  std::size_t turn = 0;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Joint& joint = joints_[j];
    Vec3 shift = Vec3::Zero(), angles = Vec3::Zero();
    for (int a = 0; a < 3; ++a) {
      if (joint.values[a] >= 0) shift[a] = posture.values[std::size_t(joint.values[a])];
      if (joint.values[3 + a] >= 0) angles[a] = posture.values[std::size_t(joint.values[3 + a])];
    }
    const Transform rest = (j > 0 ? frames_[j - 1] : base) * joint.rest;
    frames_[j] = {rest.rotation * rotationZyx(angles), rest.point(shift)};
    for (; turn < turns_.size() && turns_[turn].joint == j; ++turn)
      axes_[turn] = rest.rotation * angularVelocityZyx(angles, Vec3::Unit(turns_[turn].axis));
  }
}

// How far the end is from what is wanted: lengths over the chain's, and radians.
ReachChain::Residual ReachChain::residual(const Wanted& wanted) const {
  const Transform& end = frames_.back();
  Residual out = Residual::Zero();
  out.head<3>() = (wanted.position_m - end.point(point_m_)) / length_m_;
  if (wanted.orientation)
    out.tail<3>() = vectorOf(*wanted.orientation * Quat(end.rotation).conjugate());
  return out;
}

// How the end moves with each value.
void ReachChain::findColumns(bool turned) const {
  const Vec3 point_m = frames_.back().point(point_m_);
  for (std::size_t t = 0; t < turns_.size(); ++t) {
    const Vec3 arm_m = point_m - frames_[turns_[t].joint].translation_m;
    columns_[t].head<3>() = axes_[t].cross(arm_m) / length_m_;
    columns_[t].tail<3>() = turned ? axes_[t] : Vec3::Zero();
  }
}

// The values' changes for a step; those that would leave their limits are held.
void ReachChain::findChanges(const Residual& residual, const Posture& posture) const {
  const double damping = 0.5 * residual.squaredNorm() + kBias;
  std::ranges::fill(held_, 0);
  for (int pass = 0; pass <= kMostHeld; ++pass) {
    // (JᵀJ + λ)⁻¹ Jᵀ = Jᵀ (JJᵀ + λ)⁻¹: the smaller of the two systems.
    Mat6 system = damping * Mat6::Identity();
    for (std::size_t t = 0; t < turns_.size(); ++t)
      if (!held_[t]) system += columns_[t] * columns_[t].transpose();
    const Residual pull = system.ldlt().solve(residual);
    bool stopped = false;
    for (std::size_t t = 0; t < turns_.size(); ++t) {
      change_[t] = held_[t] ? 0 : columns_[t].dot(pull);
      const double value = posture.values[turns_[t].value];
      const bool out =
          (value >= turns_[t].max && change_[t] > 0) || (value <= turns_[t].min && change_[t] < 0);
      if (out) held_[t] = 1, stopped = true;
    }
    if (!stopped) return;
  }
}

// From the values as they are; returns the residual that is left.
double ReachChain::approach(const Wanted& wanted, Posture& posture) const {
  for (int i = 0; i < kMostSteps; ++i) {
    follow(posture, wanted.base);
    const Residual left = residual(wanted);
    if (left.norm() < kReached) return left.norm();
    findColumns(wanted.orientation.has_value());
    findChanges(left, posture);
    for (std::size_t t = 0; t < turns_.size(); ++t) {
      double& value = posture.values[turns_[t].value];
      value = std::clamp(held_[t] ? value : value + change_[t], turns_[t].min, turns_[t].max);
    }
  }
  follow(posture, wanted.base);
  return residual(wanted).norm();
}

void ReachChain::solve(const ReachGoal& goal, const PosedSkeleton& posed, Posture& posture) const {
  if (goal.weight <= 0) return;
  const Transform& end = posed.joint_world[joints_.back().id.index()];
  Wanted wanted;
  const Vec3 now_m = end.point(point_m_);
  wanted.position_m = now_m + goal.weight * (goal.position_m - now_m);
  if (goal.orientation) {
    const Quat now(end.rotation);
    const Vec3 turn = vectorOf(goal.orientation->normalized() * now.conjugate());
    wanted.orientation = rotationOf(goal.weight * turn) * now;
  }
  if (parent_.valid()) wanted.base = posed.joint_world[parent_.index()];
  const double left = approach(wanted, posture);
  if (left < kNear) return;
  // An elbow that is pushed against its stop would have to go through straight: try from the middle
  // of what it can do.
  for (std::size_t t = 0; t < turns_.size(); ++t) {
    const Turn& turn = turns_[t];
    double& value = posture.values[turn.value];
    first_[t] = value;
    if (turn.max - turn.min < 2 * kPi) value = 0.5 * (turn.min + turn.max);
  }
  if (approach(wanted, posture) < kWorthIt * left) return;
  for (std::size_t t = 0; t < turns_.size(); ++t) posture.values[turns_[t].value] = first_[t];
}

}  // namespace fascia
