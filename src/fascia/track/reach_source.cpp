#include <fascia/track/reach_source.h>

#include <algorithm>
#include <cmath>

#include <fascia/math/rotation_vector.h>

namespace fascia {
namespace {

// Half the time over which rates are measured. Solutions are good to 1e-13: longer would smooth
// what moves fast, shorter would show their rounding.
constexpr double kSolvedSpan_s = 1e-4;
// A solution that jumps to another one within that time has no speed, rad.
constexpr double kJump = 0.1;

double speedOf(double change, double per_s) {
  return std::abs(change) < kJump ? per_s * change : 0;
}

bool isFinite(const ReachGoal& goal) {
  return goal.position_m.allFinite() && goal.weight >= 0 && goal.weight <= 1 &&
         (!goal.orientation ||
          (goal.orientation->coeffs().allFinite() && goal.orientation->squaredNorm() > 1e-12));
}

}  // namespace

ReachSource::ReachSource(const Figure& figure, const PostureSource& base)
    : figure_(figure), base_(base), balls_(figure.skeleton), solved_(balls_.size(), false) {}

std::size_t ReachSource::add(const ReachChainDef& def, Goal goal) {
  Entry entry{ReachChain(figure_.skeleton, def), std::move(goal)};
  if (!entry.chain.valid())
    throw Error("a chain needs joints that turn, from its root down to its end");
  for (std::size_t i = 0; i < balls_.size(); ++i)
    if (entry.chain.contains(balls_.joint(i))) solved_[i] = true;
  entries_.push_back(std::move(entry));
  return entries_.size() - 1;
}

void ReachSource::solve(double time_s, PostureSample& out) const {
  sampleFit(base_, figure_, time_s, out);
  for (const Entry& entry : entries_) {
    const ReachGoal goal = entry.goal(time_s);
    if (!isFinite(goal)) continue;
    figure_.skeleton.pose(out.posture, posed_);
    std::erase_if(out.posture.rotations,
                  [&](const JointRotation& turn) { return entry.chain.contains(turn.joint); });
    entry.chain.solve(goal, posed_, out.posture);
  }
}

double ReachSource::distance_m(std::size_t chain, double time_s) const {
  solve(time_s, after_);
  figure_.skeleton.pose(after_.posture, posed_);
  const Entry& entry = entries_[chain];
  return (entry.chain.pointIn(posed_) - entry.goal(time_s).position_m).norm();
}

// Rates of what is solved are measured: of values, and of ball joints as rotations, whose angles
// may be solved on another side of the pole a moment later.
void ReachSource::sample(double time_s, PostureSample& out) const {
  solve(time_s - kSolvedSpan_s, before_);
  solve(time_s + kSolvedSpan_s, after_);
  solve(time_s, out);
  Posture& posture = out.posture;
  const double per_s = 1 / (2 * kSolvedSpan_s);
  for (const Entry& entry : entries_)
    for (const ReachChain::Turn& turn : entry.chain.turns())
      posture.rates[turn.value] =
          speedOf(after_.posture.values[turn.value] - before_.posture.values[turn.value], per_s);
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    if (!solved_[i]) continue;
    const JointRotation before = balls_.read(i, before_.posture),
                        after = balls_.read(i, after_.posture), now = balls_.read(i, posture);
    const Vec3 turned = vectorOf(after.rotation * before.rotation.conjugate());
    const Vec3 angular = turned.norm() < kJump ? Vec3(per_s * turned) : Vec3(Vec3::Zero());
    posture.rotations.push_back({now.joint, now.rotation, angular});
  }
  std::ranges::sort(posture.rotations, {}, &JointRotation::joint);
}

}  // namespace fascia
