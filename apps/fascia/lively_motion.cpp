#include "lively_motion.h"

#include <algorithm>
#include <functional>

#include <fascia/flesh/bind.h>

#include "shell_word.h"

namespace fascia {
namespace {

constexpr int kMoments = 24;
// A long motion is no livelier for its length, and a short one is over before it is seen.
constexpr double kLongEnough_s = 0.4;

// How far joints go on average in a second, without where the whole figure goes.
double liveliness(double duration_s,
                  const std::function<void(double, std::vector<Vec3>&)>& sample) {
  if (!(duration_s > 0)) return 0;
  double path_m = 0;
  std::vector<Vec3> before, now;
  for (int k = 0; k <= kMoments; ++k) {
    sample(duration_s * k / kMoments, now);
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : now) middle += p;
    middle /= static_cast<double>(std::max<std::size_t>(1, now.size()));
    for (Vec3& p : now) p -= middle;
    for (std::size_t j = 0; j < before.size(); ++j) path_m += (now[j] - before[j]).norm();
    before = now;
  }
  const double seconds = std::max(duration_s, kLongEnough_s);
  return path_m / (seconds * static_cast<double>(std::max<std::size_t>(1, now.size())));
}

void origins(const std::vector<Transform>& frames, std::vector<Vec3>& out) {
  out.clear();
  for (const Transform& frame : frames) out.push_back(frame.translation_m);
}

}  // namespace

std::string livelyMotion(const RiggedModel& rig) {
  std::string best;
  double most = -1;
  std::vector<Transform> world;
  for (std::size_t m = 0; m < rig.motions.size(); ++m) {
    const double found =
        liveliness(rig.motions[m].duration_s(), [&](double time_s, std::vector<Vec3>& out) {
          poseRig(rig, static_cast<int>(m), time_s, world);
          origins(world, out);
        });
    if (found > most) most = found, best = rig.motions[m].name;
  }
  return best;
}

std::string livelyMotion(const Character& character) {
  std::string best;
  double most = -1;
  Posture posture = character.skeleton().restPosture();
  PosedSkeleton posed;
  for (std::size_t m = 0; m < character.motionCount(); ++m) {
    const BoundClip& clip = character.motion(m);
    const double found = liveliness(clip.duration_s, [&](double time_s, std::vector<Vec3>& out) {
      samplePosture(clip, character.skeleton(), time_s, posture);
      character.skeleton().pose(posture, posed);
      origins(posed.joint_world, out);
    });
    if (found > most) most = found, best = clip.name;
  }
  return best;
}

std::string motionOption(const std::string& motion) {
  return motion.empty() ? std::string() : " --motion " + shellWord(motion);
}

}  // namespace fascia
