#include <fascia/io/rig_export/other_motions.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/parallel.h>
#include <fascia/io/rig_export/baked_animation.h>
#include <fascia/io/rig_export/rig_player.h>
#include <fascia/io/rig_import/gltf/gltf_clip.h>
#include <fascia/rig/blend_skinning.h>

namespace fascia {
namespace {

// Moments of each other motion at which the written file is compared with the source.
constexpr std::size_t kMeasured = 25;

}  // namespace

std::vector<double> OtherMotion::times(std::size_t count) const {
  std::vector<double> out(std::max<std::size_t>(2, count));
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = duration_s * static_cast<double>(k) / static_cast<double>(out.size() - 1);
  }
  return out;
}

BoneFrames OtherMotion::bones(const RiggedModel& model, const std::vector<double>& times_s) const {
  BoneFrames out(times_s.size());
  parallelFor(out.size(), [&](std::size_t f) {
    std::vector<Transform> world;
    poseRig(model, motion, times_s[f], world);
    restToFrame(model, world, out[f]);
  });
  return out;
}

std::vector<OtherMotion> otherMotions(const RigSource& source) {
  const RiggedModel& model = source.clip.model;
  std::vector<std::string> notes;
  const std::vector<GltfClip> clips = readGltfClips(source.document, source.scene, notes);
  std::vector<OtherMotion> out;
  for (std::size_t m = 0; m < model.motions.size(); ++m) {
    OtherMotion other{model.motions[m].name, static_cast<int>(m), 0};
    if (std::any_of(source.clips.begin(), source.clips.end(),
                    [&](const RigClip& clip) { return clip.motion == other.name; })) {
      continue;
    }
    other.animation = animationNamed(source, other.name);
    if (other.animation < 0) continue;
    other.start_s = clips.at(static_cast<std::size_t>(other.animation)).start_s();
    other.duration_s = model.motions[m].duration_s();
    if (other.duration_s > 0) out.push_back(std::move(other));
  }
  return out;
}

BoneFrames posesOfOthers(const RiggedModel& model, const std::vector<OtherMotion>& others,
                         std::size_t most) {
  BoneFrames out;
  for (const OtherMotion& other : others) {
    for (std::vector<Transform>& pose : other.bones(model, other.times(most / others.size()))) {
      out.push_back(std::move(pose));
    }
  }
  return out;
}

std::vector<RigBakeReport::Motion> measureOthers(const RigSource& source, const std::string& path,
                                                 const std::vector<OtherMotion>& others) {
  const RiggedModel& model = source.clip.model;
  std::vector<RigBakeReport::Motion> out(others.size());
  if (others.empty()) return out;
  const GltfDocument before = sourceDocumentOf(model, source.clip.scale).document,
                     after = GltfDocument::read(path);
  parallelFor(others.size(), [&](std::size_t k) {
    const OtherMotion& other = others[k];
    const double scale = source.scale;
    const RigPlayer was(before, model.parts, other.animation, scale);
    const RigPlayer is(after, model.parts, other.animation, scale);
    std::vector<Eigen::Vector3f> expected, found;
    double sum_m2 = 0, largest_m2 = 0;
    for (const double time_s : other.times(kMeasured)) {
      was.pose(other.start_s + time_s, expected);
      is.pose(other.start_s + time_s, found);
      for (std::size_t v = 0; v < found.size(); ++v) {
        const double e = (found[v] - expected[v]).cast<double>().squaredNorm();
        sum_m2 += e;
        largest_m2 = std::max(largest_m2, e);
      }
    }
    const auto entries = static_cast<double>(kMeasured * std::max<std::size_t>(1, found.size()));
    out[k] = {other.name, {1e3 * std::sqrt(sum_m2 / entries), 1e3 * std::sqrt(largest_m2)}};
  });
  return out;
}

}  // namespace fascia
