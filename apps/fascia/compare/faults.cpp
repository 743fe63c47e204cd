#include "compare/faults.h"

#include <algorithm>
#include <numeric>

namespace fascia {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// How bad a triangle is by what is wrong with it. A tear shows more than a fold, a fold more than
// stretch, of which a quarter is nothing and twice the length is as bad as it gets.
constexpr float kCrossing = 1, kTurned = 1.5f, kStretched = 0.5f;
constexpr float kFreeStretch = 1.25f, kWorstStretch = 2.f;

Eigen::Vector3f areaNormal(const Triangle& t, PointList p) {
  return 0.5f * (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
}

float longestEdgeRatio(const Triangle& t, PointList rest, PointList now) {
  float most = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t a = t[k], b = t[(k + 1) % 3];
    const float before = (rest[a] - rest[b]).norm();
    if (before > 0) most = std::max(most, (now[a] - now[b]).norm() / before);
  }
  return most;
}

}  // namespace

double Faults::sum() const {
  return std::accumulate(per_triangle.begin(), per_triangle.end(), 0.0);
}

FaultFinder::FaultFinder(const RiggedModel& model)
    : model_(model), restCrossings_(findCrossings(model.triangles, model.points_m)) {
  double total = 0;
  for (const Triangle& t : model.triangles) {
    const Eigen::Vector3f normal = areaNormal(t, model.points_m);
    areas_.push_back(normal.norm());
    normals_.push_back(normal.normalized());
    total += areas_.back();
  }
  for (float& area : areas_) area /= static_cast<float>(std::max(total, 1e-30));
}

Faults FaultFinder::find(PointList points, std::span<const Transform> motion) const {
  Faults faults;
  faults.per_triangle.assign(model_.triangles.size(), 0);
  addStretch(points, faults.per_triangle);
  faults.turned = findTurned(points, motion, faults.per_triangle);
  std::vector<bool> crosses(model_.triangles.size(), false);
  const std::vector<CrossingPair> crossings = newCrossings(
      model_.triangles, model_.points_m, restCrossings_, points, kTouching * model_.size_m());
  for (const CrossingPair& pair : crossings) crosses[pair.first] = crosses[pair.second] = true;
  faults.crossings = crossings.size();
  for (std::size_t t = 0; t < crosses.size(); ++t) {
    if (crosses[t]) faults.per_triangle[t] += kCrossing;
    faults.per_triangle[t] *= areas_[t];
  }
  faults.stretch = edgeStretch(model_.triangles, model_.points_m, points).percentile99;
  return faults;
}

// A triangle is turned when it looks away from where its bones, blended by its weights, carry its
// normal.
std::size_t FaultFinder::findTurned(PointList points, std::span<const Transform> motion,
                                    std::vector<float>& weights) const {
  std::vector<Eigen::Matrix3f> rotations;
  for (const Transform& joint : motion) rotations.push_back(joint.rotation.cast<float>());
  std::size_t count = 0;
  for (std::size_t t = 0; t < model_.triangles.size(); ++t) {
    Eigen::Vector3f carried = Eigen::Vector3f::Zero();
    for (const std::uint32_t p : model_.triangles[t])
      for (std::size_t k = 0; k < PointWeights::kMost; ++k) {
        const float weight = model_.weights[p].weight[k];
        if (weight > 0) carried += weight * (rotations[model_.weights[p].joint[k]] * normals_[t]);
      }
    if (areaNormal(model_.triangles[t], points).dot(carried) >= 0) continue;
    ++count;
    weights[t] += kTurned;
  }
  return count;
}

void FaultFinder::addStretch(PointList points, std::vector<float>& weights) const {
  for (std::size_t t = 0; t < weights.size(); ++t) {
    const float ratio = longestEdgeRatio(model_.triangles[t], model_.points_m, points);
    weights[t] +=
        kStretched * std::clamp((ratio - kFreeStretch) / (kWorstStretch - kFreeStretch), 0.f, 1.f);
  }
}

}  // namespace fascia
