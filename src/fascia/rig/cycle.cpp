#include <fascia/rig/cycle.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

// Poses count as one within these: what exporters and key reduction leave between the ends of a
// cycle is less, one frame of a slow breath is more.
constexpr double kSameAngle_rad = 0.01, kSameShift = 0.002;  // of the model's size
// A step from the last frame to the first is like its neighbours if it differs from their mean by
// less than this share of them: a walk at a dozen frames a cycle turns its joints' ways by a third.
constexpr double kStepLikeness = 0.6;
constexpr std::size_t kFewestSteps = 6;

std::vector<bool> jointsWithSkin(const RiggedModel& model) {
  std::vector<bool> has(model.joints.size(), false);
  for (const PointWeights& w : model.weights) {
    for (std::size_t k = 0; k < PointWeights::kMost && w.weight[k] > 0; ++k) has[w.joint[k]] = true;
  }
  return has;
}

double lastFrame_s(const SampledMotion& motion) {
  FASCIA_ASSERT(motion.frameCount() > 0, "a motion has frames");
  return static_cast<double>(motion.frameCount() - 1) / motion.rate_hz;
}

// Which joints end `travel` away from where they begin, rather than where they begin.
std::vector<bool> travellers(const RiggedModel& model, int motion, const Vec3& travel_m) {
  std::vector<Transform> first, last;
  poseRig(model, motion, 0, first);
  poseRig(model, motion, lastFrame_s(model.motions[static_cast<std::size_t>(motion)]), last);
  std::vector<bool> out;
  for (std::size_t j = 0; j < first.size(); ++j) {
    const Vec3 shift = last[j].translation_m - first[j].translation_m;
    out.push_back((shift - travel_m).norm() < shift.norm());
  }
  return out;
}

// How joints turn and move from one frame to another, seen from their parents.
struct Step {
  Vec3 turn, shift_m;  // rotation vector; metres
};
Step stepOf(const SampledMotion& motion, std::size_t joint, std::size_t from, std::size_t to) {
  const std::size_t a = from * motion.joints.size() + joint;
  const std::size_t b = to * motion.joints.size() + joint;
  const Eigen::AngleAxisd turn(
      (motion.rotation[a].conjugate() * motion.rotation[b]).normalized().cast<double>());
  const double angle = turn.angle() > kPi ? turn.angle() - 2 * kPi : turn.angle();
  return {angle * turn.axis(), (motion.translation_m[b] - motion.translation_m[a]).cast<double>()};
}

// Whether what lies between the last frame and the first is a step like those around it.
bool closesWithAStep(const RiggedModel& model, const SampledMotion& motion,
                     const std::vector<bool>& has) {
  const std::size_t last = motion.frameCount() - 1;
  if (last < kFewestSteps) return false;
  const double least_m = kSameShift * model.size_m();
  for (std::size_t j = 0; j < has.size(); ++j) {
    if (!has[j]) continue;
    const Step gap = stepOf(motion, j, last, 0);
    const Step before = stepOf(motion, j, last - 1, last), after = stepOf(motion, j, 0, 1);
    const auto fits = [](const Vec3& g, const Vec3& b, const Vec3& a, double least) {
      const double usual = std::max(a.norm(), b.norm());
      return (g - 0.5 * (a + b)).norm() <= kStepLikeness * usual + 2 * least;
    };
    if (!fits(gap.turn, before.turn, after.turn, kSameAngle_rad) ||
        !fits(gap.shift_m, before.shift_m, after.shift_m, least_m)) {
      return false;
    }
  }
  return true;
}

// Whether morphs end as they begin.
bool sameWeights(const SampledMotion& motion) {
  constexpr float kSameWeight = 0.01f;
  const std::size_t count = motion.morphs.size(), last = motion.weights.size() - count;
  for (std::size_t m = 0; m < count; ++m)
    if (std::abs(motion.weights[m] - motion.weights[last + m]) > kSameWeight) return false;
  return true;
}

}  // namespace

std::optional<MotionCycle> cycleOf(const RiggedModel& model, int motion) {
  const SampledMotion& m = model.motions[static_cast<std::size_t>(motion)];
  if (m.loop) return MotionCycle{Vec3::Zero(), m.duration_s()};
  if (m.frameCount() < 3) return std::nullopt;
  if (!sameWeights(m)) return std::nullopt;
  const std::vector<bool> has = jointsWithSkin(model);
  const auto root = std::find(has.begin(), has.end(), true);
  if (root == has.end()) return std::nullopt;
  std::vector<Transform> first, last;
  poseRig(model, motion, 0, first);
  poseRig(model, motion, lastFrame_s(m), last);
  const auto r = static_cast<std::size_t>(root - has.begin());
  MotionCycle cycle{last[r].translation_m - first[r].translation_m, m.duration_s()};
  const double most_m = kSameShift * model.size_m();
  for (std::size_t j = 0; j < first.size(); ++j) {
    if (!has[j]) continue;
    const Vec3 shift = last[j].translation_m - first[j].translation_m;
    const Eigen::AngleAxisd turn(first[j].rotation.transpose() * last[j].rotation);
    if ((shift - cycle.travel_m).norm() <= most_m && turn.angle() <= kSameAngle_rad) continue;
    if (!closesWithAStep(model, m, has)) return std::nullopt;
    return MotionCycle{Vec3::Zero(), m.duration_s() + 1 / m.rate_hz};
  }
  if (cycle.travel_m.norm() <= most_m) cycle.travel_m.setZero();
  return cycle;
}

SampledMotion playedTwice(const RiggedModel& model, int motion, const MotionCycle& cycle) {
  const SampledMotion& once = model.motions[static_cast<std::size_t>(motion)];
  const std::size_t joints = once.joints.size();
  const auto period = static_cast<std::size_t>(std::lround(cycle.period_s * once.rate_hz));
  const std::vector<bool> travels = travellers(model, motion, cycle.travel_m);
  SampledMotion out = once;
  out.loop = false;
  out.rotation.clear();
  out.translation_m.clear();
  out.weights.clear();
  std::vector<Transform> world;
  for (std::size_t f = 0; f <= 2 * period; ++f) {
    // The end of a time is the beginning of the next; the very last frame may be the motion's own.
    const bool own = f == 2 * period && period < once.frameCount();
    const std::size_t source = own ? period : f % period;
    const std::size_t round = own ? 1 : f / period;
    const auto times = static_cast<double>(round);
    poseRig(model, motion, static_cast<double>(source) / once.rate_hz, world);
    for (std::size_t m = 0; m < once.morphs.size(); ++m)
      out.weights.push_back(once.weights[source * once.morphs.size() + m]);
    for (std::size_t j = 0; j < joints; ++j) {
      const int parent = model.joints[j].parent;
      const auto p = static_cast<std::size_t>(std::max(parent, 0));
      Vec3 shift = times * cycle.travel_m;
      if (!travels[j] || (parent >= 0 && travels[p])) shift.setZero();
      if (parent >= 0) shift = world[p].rotation.transpose() * shift;
      Eigen::Quaternionf q = once.rotation[source * joints + j];
      // Neighbours in time stay in one hemisphere.
      if (f > 0 && q.dot(out.rotation[(f - 1) * joints + j]) < 0) q.coeffs() *= -1;
      out.rotation.push_back(q);
      out.translation_m.push_back(once.translation_m[source * joints + j] + shift.cast<float>());
    }
  }
  return out;
}

}  // namespace fascia
