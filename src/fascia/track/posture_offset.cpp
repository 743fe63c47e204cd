#include <fascia/track/posture_offset.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/math/rotation_vector.h>

namespace fascia {
namespace {

// Critically damped, 1 − (1 + s) e⁻ˢ of a difference at rest is gone at s: two thirds at 2.3.
constexpr double kReach = 2.3;
constexpr double kShortestReach_s = 1e-4;
// A difference is forgotten when less than this is left: 1e-12 and less of it.
constexpr double kForgotten = 32;

void subtract(const std::vector<double>& a, const std::vector<double>& b,
              std::vector<double>& difference) {
  FASCIA_ASSERT(a.size() == b.size(), "both are of one figure");
  difference.resize(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) difference[i] = a[i] - b[i];
}

}  // namespace

PostureOffset::PostureOffset(const Figure& figure, double reach_s)
    : figure_(figure),
      balls_(figure.skeleton),
      stiffness_per_s_(kReach / std::max(reach_s, kShortestReach_s)) {}

void PostureOffset::start(double time_s, const PostureSample& actual, const PostureSample& goal) {
  active_ = true;
  start_s_ = time_s;
  subtract(actual.posture.values, goal.posture.values, values_);
  subtract(actual.posture.rates, goal.posture.rates, rates_);
  subtract(actual.morphs.weights, goal.morphs.weights, weights_);
  subtract(actual.morphs.rates, goal.morphs.rates, weightRates_);
  startTurns(actual.posture, goal.posture);
}

void PostureOffset::startTurns(const Posture& actual, const Posture& goal) {
  turns_.resize(balls_.size()), turnRates_.resize(balls_.size());
  balls_.read(goal, goal_);
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    const JointRotation from = balls_.read(i, actual);
    const JointRotation& to = goal_[i];
    const Quat step = from.rotation * to.rotation.conjugate();
    turns_[i] = vectorOf(step);
    turnRates_[i] = vectorRateOf(turns_[i], from.angular_rad_per_s - step * to.angular_rad_per_s);
  }
}

// x(t) = (x₀ + (v₀ + k x₀) t) e^(−k t) solves x'' = −k² x − 2 k x'.
PostureOffset::Left PostureOffset::left(double time_s) const {
  const double k = stiffness_per_s_, t = std::max(0.0, time_s - start_s_);
  const double e = std::exp(-k * t);
  return {(1 + k * t) * e, t * e, -k * k * t * e, (1 - k * t) * e};
}

void PostureOffset::apply(double time_s, PostureSample& goal) const {
  if (!active_ || stiffness_per_s_ * (time_s - start_s_) > kForgotten) return;
  const Left l = left(time_s);
  Posture& posture = goal.posture;
  balls_.read(posture, goal_);
  for (std::size_t v = 0; v < posture.values.size(); ++v) {
    if (balls_.contains(v)) continue;
    posture.values[v] += l.share * values_[v] + l.rateShare * rates_[v];
    posture.rates[v] += l.shareRate * values_[v] + l.rateShareRate * rates_[v];
  }
  applyTurns(l, posture);
  figure_.skeleton.clampToLimits(posture);
  for (std::size_t i = 0; i < goal.morphs.weights.size(); ++i) {
    goal.morphs.weights[i] += l.share * weights_[i] + l.rateShare * weightRates_[i];
    goal.morphs.rates[i] += l.shareRate * weights_[i] + l.rateShareRate * weightRates_[i];
  }
  figure_.morphs.admit(goal.morphs);
}

void PostureOffset::applyTurns(const Left& l, Posture& goal) const {
  goal.rotations.resize(balls_.size());
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    const Vec3 phi = l.share * turns_[i] + l.rateShare * turnRates_[i];
    const Vec3 phiRate = l.shareRate * turns_[i] + l.rateShareRate * turnRates_[i];
    const Quat step = rotationOf(phi);
    goal.rotations[i] = {goal_[i].joint, (step * goal_[i].rotation).normalized(),
                         angularVelocityOf(phi, phiRate) + step * goal_[i].angular_rad_per_s};
  }
}

}  // namespace fascia
