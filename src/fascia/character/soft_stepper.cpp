#include <fascia/character/soft_stepper.h>

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include <fascia/base/assert.h>
#include <fascia/math/ode/between.h>

namespace fascia {
namespace {

// Implicit Euler damps a swing of ω by about ω h / 2 of critical: 2 % at 3 Hz.
constexpr double kSubstep_s = 1.0 / 480;
// A held point that goes farther than this part of its body's size in a substep was not moved there
// by anything physical.
constexpr double kJump = 0.5;
// Steps to equilibrium, each at rest again: what swings at 1 Hz comes nearer by a factor of 3 in
// one, what is faster by more.
constexpr double kSettleStep_s = 0.2;
constexpr int kSettleSteps = 40;
// Less than this part of the volume is left at the middle: the body is all but inside out, and its
// energy would keep it so.
constexpr double kLeastVolume = 0.05;

}  // namespace

SoftStepper::SoftStepper(std::shared_ptr<const SoftFlesh> flesh, const Vec3& gravity_m_per_s2)
    : flesh_(std::move(flesh)),
      gravity_m_per_s2_(gravity_m_per_s2),
      system_(flesh_->model(), {.gravity_m_per_s2 = gravity_m_per_s2}),
      stepper_(system_, {.tolerance = 1e-8}) {
  for (std::size_t p = 0; p < flesh_->parts().size(); ++p) {
    const SoftFlesh::Part& part = flesh_->parts()[p];
    for (const Vec3& held_m : part.held_m)
      system_.hold(makeTrajectory(
          "held point", {part.body, held_m},
          [this, p, held_m](double time_s) { return heldPoint(p, held_m, time_s); }));
  }
}

// Cubic between the substep's ends, with the velocities of the joint's own motion there.
PathPoint SoftStepper::heldPoint(std::size_t part, const Vec3& held_m, double time_s) const {
  const Carrier &a = from_[part], &b = to_[part];
  FASCIA_ASSERT(step_s_ > 0, "a substep lasts");
  const Vec3 x0 = a.frame.point(held_m), x1 = b.frame.point(held_m);
  const double h = step_s_, u = (time_s - from_s_) / h;
  const Vec3 v0 = h * a.twist.at(x0), v1 = h * b.twist.at(x1);
  // x0 + u v0 + u² c + u³ d
  const Vec3 c = 3 * (x1 - x0) - 2 * v0 - v1, d = 2 * (x0 - x1) + v0 + v1;
  return {x0 + u * (v0 + u * (c + u * d)), (v0 + u * (2 * c + 3 * u * d)) / h,
          (2 * c + 6 * u * d) / (h * h)};
}

void SoftStepper::readCarriers(const PosedSkeleton& pose, std::vector<Carrier>& carriers) const {
  carriers.resize(flesh_->parts().size());
  FASCIA_ASSERT(pose.joint_world.size() == pose.twist_world.size(), "the skeleton is posed");
  for (std::size_t p = 0; p < carriers.size(); ++p) {
    const SoftFlesh::Part& part = flesh_->parts()[p];
    carriers[p] = {pose.joint_world[part.joint.index()] * part.inJoint,
                   pose.twist_world[part.joint.index()]};
  }
}

std::size_t SoftStepper::advance(const Poses& poses, double end_s, OdeState& bodies) {
  const double start_s = bodies.t_s, span_s = end_s - start_s;
  FASCIA_ASSERT(bodies.r.size() == flesh_->model().size() && bodies.v.size() == bodies.r.size(),
                "the state is of these bodies");
  const int steps = std::max(1, static_cast<int>(std::ceil(span_s / kSubstep_s - 1e-6)));
  std::size_t putBack = 0;
  keptCount_ = 0;
  keep(bodies);
  readCarriers(poses(start_s), from_);
  for (int i = 0; i < steps; ++i) {
    from_s_ = start_s + span_s * i / steps;
    step_s_ = span_s / steps;
    readCarriers(poses(start_s + span_s * (i + 1) / steps), to_);
    putBack += followJumps(bodies);
    bodies.t_s = from_s_;
    stepper_.step(step_s_, bodies);
    bodies.t_s = i + 1 == steps ? end_s : start_s + span_s * (i + 1) / steps;
    putBack += repair(bodies);
    keep(bodies);
    std::swap(from_, to_);
  }
  return putBack;
}

// A body whose joint jumps is taken along as it is.
std::size_t SoftStepper::followJumps(OdeState& bodies) {
  FASCIA_ASSERT(from_.size() == flesh_->parts().size() && to_.size() == from_.size(),
                "every soft solid is carried");
  std::size_t count = 0;
  for (std::size_t p = 0; p < from_.size(); ++p) {
    const SoftFlesh::Part& part = flesh_->parts()[p];
    const Transform motion = to_[p].frame * from_[p].frame.inverse();
    double way_m = 0;
    for (const Vec3& held_m : part.held_m)
      way_m = std::max(way_m, (to_[p].frame.point(held_m) - from_[p].frame.point(held_m)).norm());
    if (way_m < kJump * flesh_->model().shape(part.body).size_m()) continue;
    flesh_->carry(part, motion, bodies);
    from_[p] = to_[p];
    ++count;
  }
  return count;
}

// What is inside out starts anew, undeformed.
std::size_t SoftStepper::repair(OdeState& bodies) const {
  const BodyModel& model = flesh_->model();
  std::size_t count = 0;
  for (std::size_t p = 0; p < to_.size(); ++p) {
    const SoftFlesh::Part& part = flesh_->parts()[p];
    const BodyShape& shape = model.shape(part.body);
    const auto q = model.part(part.body, std::span<const double>(bodies.r));
    if (shape.deformationGradient(q, shape.center_m()).determinant() > kLeastVolume) continue;
    model.place(part.body, to_[p].frame, bodies);
    shape.setRigidVelocity(q, to_[p].twist, model.part(part.body, std::span<double>(bodies.v)));
    ++count;
  }
  return count;
}

void SoftStepper::settle(const PosedSkeleton& pose, OdeState& bodies) {
  readCarriers(pose, from_);
  for (Carrier& carrier : from_) carrier.twist = {};
  to_ = from_;
  const double time_s = bodies.t_s;
  step_s_ = kSettleStep_s;
  for (int i = 0; i < kSettleSteps; ++i) {
    bodies.t_s = from_s_ = time_s;
    std::ranges::fill(bodies.v, 0.0);
    stepper_.step(kSettleStep_s, bodies);
  }
  std::ranges::fill(bodies.v, 0.0);
  bodies.t_s = time_s;
  keptCount_ = 0;
  keep(bodies);
}

void SoftStepper::keep(const OdeState& bodies) {
  if (keptCount_ == kept_.size()) kept_.emplace_back();
  kept_[keptCount_++] = bodies;
}

const OdeState& SoftStepper::at(double time_s) {
  FASCIA_ASSERT(keptCount_ > 0 && keptCount_ <= kept_.size(), "something was stepped");
  std::size_t i = 0;
  while (i + 2 < keptCount_ && kept_[i + 1].t_s <= time_s) ++i;
  between(kept_[i], kept_[std::min(i + 1, keptCount_ - 1)], time_s, between_);
  return between_;
}

SoftStepper& SoftWorkspace::stepper(const std::shared_ptr<const SoftFlesh>& flesh,
                                    const Vec3& gravity_m_per_s2) {
  if (!stepper_ || !stepper_->isFor(*flesh, gravity_m_per_s2))
    stepper_ = std::make_unique<SoftStepper>(flesh, gravity_m_per_s2);
  return *stepper_;
}

}  // namespace fascia
