#include <fascia/skin/posed_skin_run.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace fascia {
namespace {

// Joints that move farther than this share of the figure's size within one frame have been put
// somewhere else: the flesh goes along at rest.
constexpr double kJointJump = 0.2;

bool hasJumped(std::span<const Transform> before, std::span<const Transform> now, double size_m) {
  for (std::size_t j = 0; j < before.size() && j < now.size(); ++j)
    if (!((now[j].translation_m - before[j].translation_m).norm() < kJointJump * size_m))
      return true;
  return false;
}

}  // namespace

void PosedSkinRun::advance(SkinPoseSource& poses, double start_s, double end_s, SkinState& state,
                           SkinStats& stats) {
  const auto begin = std::chrono::steady_clock::now();
  const SkinPose pose = poses.at(end_s);
  const auto posed = std::chrono::steady_clock::now();
  if (hasJumped(state.joints, pose.joints, skin_.size_m())) state.jiggle = {};
  evaluateRigged(*skin_.rigged(), pose, end_s - start_s, &state.jiggle, scratch_, state.position);
  state.joints.assign(pose.joints.begin(), pose.joints.end());
  const auto end = std::chrono::steady_clock::now();
  stats.other_s += std::chrono::duration<double>(posed - begin).count();
  stats.forces_s += std::chrono::duration<double>(end - posed).count();
  stats.steps += 1;
  stats.step_min_s = std::min(stats.step_min_s, end_s - start_s);
  stats.step_max_s = std::max(stats.step_max_s, end_s - start_s);
}

}  // namespace fascia
