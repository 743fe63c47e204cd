#include "bench/deformation/judge.h"

#include <algorithm>
#include <numeric>

#include <fascia/rig/blend_skinning.h>

namespace fascia {
namespace {

// Crossings and stretch are looked at in every so many frames of a clip: finding crossings takes
// longer than most ways of skinning.
constexpr std::size_t kLookEvery = 4;

EdgeStretch worse(const EdgeStretch& a, const EdgeStretch& b) {
  return {std::max(a.largest, b.largest), std::max(a.percentile99, b.percentile99)};
}

}  // namespace

Judge::Judge(const RiggedModel& model)
    : model_(model),
      bones_(dominantJoints(model)),
      restCrossings_(findCrossings(model.triangles, model.points_m)) {
  computeNormals(model.points_m, model.triangles, normals_);
}

BendScore Judge::judgeBend(const Hinge& hinge, const ContestStage& stage,
                           const ContestFrames& performance) const {
  const HingeRegion region = regionOf(model_, hinge);
  const PointList rest = model_.points_m, now = performance.frames.back();
  BendScore score;
  score.volume_loss = jointVolumeLoss(region.limb, region.nearJoint, rest, now);
  score.loss_at_rest =
      jointVolumeLoss(region.limb, region.nearJoint, rest, performance.frames.front());
  score.crossings = newCrossings(restCrossings_, findCrossings(model_.triangles, now));
  score.stretch = edgeStretch(region.nearJoint, rest, now);
  score.slide =
      skinSlide(region.pointsNearJoint, rest, normals_, {bones_, stage.motions.back()}, now);
  return score;
}

ClipScore Judge::judgeClip(const ContestStage& stage, const ContestFrames& performance) const {
  ClipScore score;
  std::vector<std::uint32_t> all(model_.points_m.size());
  std::iota(all.begin(), all.end(), 0u);
  std::vector<std::vector<Eigen::Vector3f>> seen(performance.frames.size());
  for (std::size_t f = 0; f < seen.size(); ++f) {
    const PointList points = performance.frames[f];
    const Carriers carriers{bones_, stage.motions[f]};
    intoBones(carriers, points, seen[f]);
    if (f % kLookEvery != 0) continue;
    const std::size_t crossings =
        newCrossings(restCrossings_, findCrossings(model_.triangles, points));
    score.crossings = std::max(score.crossings, crossings);
    score.stretch = worse(score.stretch, edgeStretch(model_.triangles, model_.points_m, points));
    const SkinSlide slide = skinSlide(all, model_.points_m, normals_, carriers, points);
    score.slide.rms_m = std::max(score.slide.rms_m, slide.rms_m);
    score.slide.largest_m = std::max(score.slide.largest_m, slide.largest_m);
  }
  score.jitter_m = jitter_m(seen);
  return score;
}

}  // namespace fascia
