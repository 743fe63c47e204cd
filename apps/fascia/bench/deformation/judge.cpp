#include "bench/deformation/judge.h"

#include <algorithm>
#include <numeric>

#include <fascia/rig/blend_skinning.h>

namespace fascia {
namespace {

// All but jitter are looked at in every so many frames of a clip: finding crossings takes longer
// than most ways of skinning.
constexpr std::size_t kLookEvery = 4;

// Of two frames the worse, measure by measure.
void takeWorse(Score& score, const Score& frame) {
  const auto larger = [](auto& value, const auto& other) { value = std::max(value, other); };
  larger(score.crossings, frame.crossings);
  larger(score.crossings_in_piece, frame.crossings_in_piece);
  larger(score.turned, frame.turned);
  larger(score.lumpiness.rms, frame.lumpiness.rms);
  larger(score.lumpiness.percentile99, frame.lumpiness.percentile99);
  larger(score.stretch.largest, frame.stretch.largest);
  larger(score.stretch.percentile99, frame.stretch.percentile99);
  larger(score.slide.rms_m, frame.slide.rms_m);
  larger(score.slide.largest_m, frame.slide.largest_m);
}

double largestDistance(PointList a, PointList b) {
  double largest = 0;
  for (std::size_t p = 0; p < a.size(); ++p)
    largest = std::max(largest, static_cast<double>((a[p] - b[p]).norm()));
  return largest;
}

}  // namespace

Judge::Judge(const RiggedModel& model)
    : model_(model),
      bones_(dominantJoints(model)),
      restCrossings_(findCrossings(model.triangles, model.points_m)),
      touching_m_(kTouching * model.size_m()),
      detail_(model.triangles, model.points_m) {
  computeNormals(model.points_m, model.triangles, normals_);
}

std::vector<CrossingPair> Judge::crossingsOf(PointList points) const {
  return newCrossings(model_.triangles, model_.points_m, restCrossings_, points, touching_m_);
}

void Judge::countCrossings(PointList points, Score& score) const {
  const auto pieceOf = [this](std::uint32_t t) { return model_.component[model_.triangles[t][0]]; };
  const std::vector<CrossingPair> pairs = crossingsOf(points);
  score.crossings = pairs.size();
  score.crossings_in_piece = static_cast<std::size_t>(std::count_if(
      pairs.begin(), pairs.end(),
      [&](const CrossingPair& pair) { return pieceOf(pair.first) == pieceOf(pair.second); }));
}

std::size_t Judge::turnedOf(const std::vector<Transform>& motion, PointList points) const {
  std::vector<Eigen::Matrix3f> turns, carried(points.size(), Eigen::Matrix3f::Zero());
  for (const Transform& m : motion) turns.push_back(m.rotation.cast<float>());
  for (std::size_t p = 0; p < points.size(); ++p)
    for (std::size_t k = 0; k < PointWeights::kMost; ++k)
      carried[p] += model_.weights[p].weight[k] * turns[model_.weights[p].joint[k]];
  return turnedTriangles(model_.triangles, model_.points_m, carried, points);
}

Score Judge::judgePose(const HingeRegion& region, const ContestStage& stage,
                       const ContestFrames& performance) const {
  const PointList rest = model_.points_m, now = performance.frames.back();
  const PointList first = performance.frames.front();
  const std::vector<Transform>& motion = stage.motions.back();
  Score score;
  countCrossings(now, score);
  score.turned = turnedOf(motion, now);
  score.lumpiness = lumpiness(detail_, region.pointsNearJoint, now);
  score.stretch = edgeStretch(region.nearJoint, rest, now);
  score.slide = skinSlide(region.pointsNearJoint, rest, normals_, {bones_, motion}, now);
  score.volume_loss = jointVolumeLoss(region.limb, region.nearJoint, rest, now);
  score.loss_at_rest = jointVolumeLoss(region.limb, region.nearJoint, rest, first);
  score.rest_error_m = largestDistance(first, rest);
  return score;
}

Score Judge::judgeClip(const ContestStage& stage, const ContestFrames& performance) const {
  Score score;
  std::vector<std::uint32_t> all(model_.points_m.size());
  std::iota(all.begin(), all.end(), 0u);
  std::vector<std::vector<Eigen::Vector3f>> seen(performance.frames.size());
  for (std::size_t f = 0; f < seen.size(); ++f) {
    const PointList points = performance.frames[f];
    const Carriers carriers{bones_, stage.motions[f]};
    intoBones(carriers, points, seen[f]);
    if (f % kLookEvery != 0) continue;
    Score frame;
    countCrossings(points, frame);
    frame.turned = turnedOf(stage.motions[f], points);
    frame.lumpiness = lumpiness(detail_, all, points);
    frame.stretch = edgeStretch(model_.triangles, model_.points_m, points);
    frame.slide = skinSlide(all, model_.points_m, normals_, carriers, points);
    takeWorse(score, frame);
  }
  score.jitter_m = jitter_m(seen);
  return score;
}

}  // namespace fascia
