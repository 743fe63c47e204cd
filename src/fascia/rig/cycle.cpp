#include <fascia/rig/cycle.h>

#include <algorithm>

namespace fascia {
namespace {

// Poses count as one within these: what exporters and key reduction leave between the ends of a
// cycle is less, one frame of a slow breath is more.
constexpr double kSameAngle_rad = 0.01, kSameShift = 0.002;  // of the model's size

std::vector<bool> jointsWithSkin(const RiggedModel& model) {
  std::vector<bool> has(model.joints.size(), false);
  for (const PointWeights& w : model.weights) {
    for (std::size_t k = 0; k < PointWeights::kMost && w.weight[k] > 0; ++k) has[w.joint[k]] = true;
  }
  return has;
}

double lastFrame_s(const SampledMotion& motion) {
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

}  // namespace

std::optional<MotionCycle> cycleOf(const RiggedModel& model, int motion) {
  const SampledMotion& m = model.motions[static_cast<std::size_t>(motion)];
  if (m.loop) return MotionCycle{};
  if (m.frameCount() < 3) return std::nullopt;
  std::vector<Transform> first, last;
  poseRig(model, motion, 0, first);
  poseRig(model, motion, lastFrame_s(m), last);
  const std::vector<bool> has = jointsWithSkin(model);
  const auto root = std::find(has.begin(), has.end(), true);
  if (root == has.end()) return std::nullopt;
  const auto r = static_cast<std::size_t>(root - has.begin());
  MotionCycle cycle{last[r].translation_m - first[r].translation_m};
  const double most_m = kSameShift * model.size_m();
  for (std::size_t j = 0; j < first.size(); ++j) {
    if (!has[j]) continue;
    const Vec3 shift = last[j].translation_m - first[j].translation_m;
    if ((shift - cycle.travel_m).norm() > most_m) return std::nullopt;
    if (Eigen::AngleAxisd(first[j].rotation.transpose() * last[j].rotation).angle() >
        kSameAngle_rad) {
      return std::nullopt;
    }
  }
  if (cycle.travel_m.norm() <= most_m) cycle.travel_m.setZero();
  return cycle;
}

SampledMotion playedTwice(const RiggedModel& model, int motion, const MotionCycle& cycle) {
  const SampledMotion& once = model.motions[static_cast<std::size_t>(motion)];
  const std::size_t joints = once.joints.size();
  // The doubled pose between the two is there once: as the second time begins.
  const std::size_t period = once.loop ? once.frameCount() : once.frameCount() - 1;
  const std::size_t skipped = (once.frameCount() - period) * joints;
  SampledMotion out = once;
  out.rotation.resize(out.rotation.size() - skipped);
  out.translation_m.resize(out.translation_m.size() - skipped);
  out.rotation.insert(out.rotation.end(), once.rotation.begin(), once.rotation.end());
  out.translation_m.insert(out.translation_m.end(), once.translation_m.begin(),
                           once.translation_m.end());
  const std::vector<bool> travels = travellers(model, motion, cycle.travel_m);
  std::vector<Transform> world;
  for (std::size_t f = period; f < out.frameCount(); ++f) {
    poseRig(model, motion, static_cast<double>(f - period) / once.rate_hz, world);
    for (std::size_t j = 0; j < joints; ++j) {
      const int parent = model.joints[j].parent;
      const auto p = static_cast<std::size_t>(std::max(parent, 0));
      if (!travels[j] || (parent >= 0 && travels[p])) continue;
      const Vec3 shift =
          parent < 0 ? cycle.travel_m : Vec3(world[p].rotation.transpose() * cycle.travel_m);
      out.translation_m[f * joints + j] += shift.cast<float>();
    }
  }
  // Neighbours in time stay in one hemisphere.
  for (std::size_t i = joints; i < out.rotation.size(); ++i) {
    if (out.rotation[i].dot(out.rotation[i - joints]) < 0) out.rotation[i].coeffs() *= -1;
  }
  return out;
}

}  // namespace fascia
