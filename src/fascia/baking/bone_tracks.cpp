#include <fascia/baking/bone_tracks.h>

#include <algorithm>

#include <fascia/base/parallel.h>

namespace fascia {

double sizeOf(std::span<const Vec3> points) {
  Box box;
  for (const Vec3& p : points) box.add(p);
  return box.empty() ? 0 : box.size().norm();
}

Vec3 blendPoint(const Vec3& rest, const PointWeights& weights, const BoneTracks& bones,
                std::size_t frame) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < PointWeights::kMost && weights.weight[k] > 0; ++k) {
    sum += static_cast<double>(weights.weight[k]) * bones.at(weights.joint[k], frame).point(rest);
  }
  return sum;
}

std::vector<PointError> pointErrors(const SkinningProblem& problem,
                                    std::span<const PointWeights> weights, const BoneTracks& bones,
                                    FrameRange frames) {
  std::vector<PointError> errors(problem.pointCount());
  parallelFor(problem.pointCount(), [&](std::size_t i) {
    for (std::size_t f = frames.first; f < frames.end; ++f) {
      const double e = (blendPoint(problem.rest_m[i], weights[i], bones, f) -
                        problem.target(i, f).cast<double>())
                           .squaredNorm();
      errors[i].sum_m2 += e;
      errors[i].largest_m2 = std::max(errors[i].largest_m2, e);
    }
  });
  return errors;
}

void squaredErrors(const SkinningProblem& problem, std::span<const PointWeights> weights,
                   const BoneTracks& bones, FrameRange frames, std::vector<double>& error) {
  error.clear();
  for (const PointError& e : pointErrors(problem, weights, bones, frames))
    error.push_back(e.sum_m2);
}

}  // namespace fascia
