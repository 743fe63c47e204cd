#include <fascia/io/rig_model/motion_sampling.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/index.h>
#include <fascia/base/suggest.h>

namespace fascia {
namespace {

constexpr double kMostJointFrames = 5e6;  // 28 bytes each
constexpr double kSlowest_hz = 1;         // a motion that would be coarser is left out

MotionPlan planOf(double duration_s, double rate_hz) {
  if (!(duration_s > 0)) return {rate_hz, 1};
  const double steps = std::max(1.0, std::round(duration_s * rate_hz));
  return {steps / duration_s, static_cast<std::size_t>(std::min(steps, 1e15)) + 1};
}

}  // namespace

std::vector<MotionPlan> planMotions(std::span<const MotionSpan> motions, std::size_t nodes,
                                    std::vector<std::string>& notes) {
  std::vector<MotionPlan> plans;
  const double most = kMostJointFrames / static_cast<double>(nodes);
  double frames = 0;
  for (const MotionSpan& motion : motions) {
    const bool endless = motion.duration_s * kSlowest_hz > most;
    plans.push_back(endless ? MotionPlan{} : planOf(motion.duration_s, motion.rate_hz));
    frames += static_cast<double>(plans.back().frames);
    if (endless)
      notes.push_back("the motion " + quotedName(motion.name) + " is too long: left out");
  }
  if (frames <= most) return plans;
  const double share = most / frames;
  notes.push_back("the motions are long: about " +
                  std::to_string(static_cast<int>(std::ceil(100 * share))) +
                  " % of their frames are kept");
  for (std::size_t i = 0; i < motions.size(); ++i) {
    if (plans[i].frames > 0) plans[i] = planOf(motions[i].duration_s, plans[i].rate_hz * share);
  }
  return plans;
}

void appendFrame(const RiggedModel& model, const std::vector<Transform>& world,
                 SampledMotion& motion) {
  const std::size_t count = world.size(), before = motion.rotation.size();
  for (std::size_t j = 0; j < count; ++j) {
    const int parent = model.joints[j].parent;
    const Transform local = parent < 0 ? world[j] : world[at(parent)].inverse() * world[j];
    Eigen::Quaternionf q = Quat(local.rotation).normalized().cast<float>();
    const bool turned = before > 0 ? q.dot(motion.rotation[before - count + j]) < 0 : q.w() < 0;
    if (turned) q.coeffs() = -q.coeffs();
    motion.rotation.push_back(q);
    motion.translation_m.push_back(local.translation_m.cast<float>());
  }
}

void closeLoop(double size_m, SampledMotion& motion) {
  constexpr float kSameAngle_rad = 0.01f, kSameShift = 0.002f;  // of the size
  constexpr float kSameWeight = 0.01f;
  const std::size_t count = motion.joints.size(), last = motion.rotation.size() - count;
  if (last < 2 * count) return;
  const float shift = kSameShift * static_cast<float>(size_m);
  for (std::size_t j = 0; j < count; ++j) {
    if (motion.rotation[j].angularDistance(motion.rotation[last + j]) > kSameAngle_rad) return;
    if ((motion.translation_m[j] - motion.translation_m[last + j]).norm() > shift) return;
  }
  const std::size_t morphs = motion.morphs.size(), lastWeight = motion.weights.size() - morphs;
  for (std::size_t m = 0; m < morphs; ++m)
    if (std::abs(motion.weights[m] - motion.weights[lastWeight + m]) > kSameWeight) return;
  motion.loop = true;
  motion.weights.resize(lastWeight);
  motion.rotation.resize(last);
  motion.translation_m.resize(last);
}

std::string MotionNames::next(const std::string& name) {
  const int number = ++counts_[name];
  return number > 1 ? name + " (" + std::to_string(number) + ")" : name;
}

}  // namespace fascia
