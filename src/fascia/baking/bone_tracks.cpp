#include <fascia/baking/bone_tracks.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/parallel.h>

namespace fascia {

Vec3 blendPoint(const Vec3& rest, const PointWeights& weights, const BoneTracks& bones,
                std::size_t frame) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < PointWeights::kMost && weights.weight[k] > 0; ++k) {
    sum += static_cast<double>(weights.weight[k]) * bones.at(weights.joint[k], frame).point(rest);
  }
  return sum;
}

void squaredErrors(const SkinningProblem& problem, std::span<const PointWeights> weights,
                   const BoneTracks& bones, FrameRange frames, std::vector<double>& error) {
  error.resize(problem.pointCount());
  parallelFor(problem.pointCount(), [&](std::size_t i) {
    double sum = 0;
    for (std::size_t f = frames.first; f < frames.end; ++f) {
      sum += (blendPoint(problem.rest_m[i], weights[i], bones, f) -
              problem.target(i, f).cast<double>())
                 .squaredNorm();
    }
    error[i] = sum;
  });
}

double largestError(const SkinningProblem& problem, std::span<const PointWeights> weights,
                    const BoneTracks& bones) {
  std::vector<double> largest(problem.pointCount(), 0.0);
  parallelFor(problem.pointCount(), [&](std::size_t i) {
    for (std::size_t f = 0; f < problem.frameCount; ++f) {
      largest[i] = std::max(largest[i], (blendPoint(problem.rest_m[i], weights[i], bones, f) -
                                         problem.target(i, f).cast<double>())
                                            .squaredNorm());
    }
  });
  return largest.empty() ? 0 : std::sqrt(*std::max_element(largest.begin(), largest.end()));
}

}  // namespace fascia
