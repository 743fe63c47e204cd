#include <fascia/baking/helper_bones.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/SVD>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// Share of the points' spread that pulls a rotation towards the one before. Far below what any real
// patch says, far above rounding.
constexpr double kLikeness = 1e-9;

struct Use {
  std::uint32_t point;
  double weight;
};

std::vector<std::vector<Use>> usesOf(std::span<const PointWeights> weights, std::size_t first,
                                     std::size_t boneCount) {
  std::vector<std::vector<Use>> uses(boneCount - first);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    for (std::size_t k = 0; k < PointWeights::kMost && weights[i].weight[k] > 0; ++k) {
      const std::size_t bone = weights[i].joint[k];
      if (bone < first) continue;
      uses[bone - first].push_back(
          {static_cast<std::uint32_t>(i), static_cast<double>(weights[i].weight[k])});
    }
  }
  return uses;
}

Vec3 centerOf(const SkinningProblem& problem, const std::vector<Use>& uses) {
  Vec3 sum = Vec3::Zero();
  double mass = 0;
  for (const Use& use : uses) {
    sum += use.weight * problem.rest_m[use.point];
    mass += use.weight;
  }
  return sum / mass;
}

// Gauss–Seidel over the helpers in one frame; `left` is target minus blend at every point.
void sweepFrame(const SkinningProblem& problem, const std::vector<std::vector<Use>>& uses,
                const std::vector<Vec3>& centers, std::size_t firstHelper, std::size_t frame,
                std::vector<Vec3>& left, BoneTracks& bones) {
  for (std::size_t h = 0; h < uses.size(); ++h) {
    if (uses[h].empty()) continue;
    Transform& bone = bones.track(firstHelper + h)[frame];
    RigidFit fit(centers[h]);
    for (const Use& use : uses[h]) {
      const Vec3& p = problem.rest_m[use.point];
      left[use.point] += use.weight * bone.point(p);
      fit.add(p, use.weight, left[use.point]);
    }
    bone = fit.solve(bone);
    for (const Use& use : uses[h]) {
      left[use.point] -= use.weight * bone.point(problem.rest_m[use.point]);
    }
  }
}

// The joint of the patch's own that carries it best, where it needs help; joints with little of it
// do not count.
int parentOf(const SkinningProblem& problem, std::span<const PointWeights> rigWeights,
             const BoneTracks& bones, std::span<const std::uint32_t> patch,
             std::span<const double> say) {
  std::map<std::size_t, double> share;
  double all = 0;
  for (std::size_t p = 0; p < patch.size(); ++p) {
    const PointWeights& w = rigWeights[patch[p]];
    for (std::size_t k = 0; k < PointWeights::kMost && w.weight[k] > 0; ++k) {
      share[w.joint[k]] += say[p] * static_cast<double>(w.weight[k]);
    }
    all += say[p];
  }
  int best = 0;
  double bestError = -1;
  for (const auto& [joint, sum] : share) {
    if (sum < 0.1 * all) continue;
    double error = 0;
    for (std::size_t p = 0; p < patch.size(); ++p) {
      for (std::size_t f = 0; f < problem.frameCount; ++f) {
        error += say[p] * (bones.at(joint, f).point(problem.rest_m[patch[p]]) -
                           problem.target(patch[p], f).cast<double>())
                              .squaredNorm();
      }
    }
    if (bestError < 0 || error < bestError) best = static_cast<int>(joint), bestError = error;
  }
  return best;
}

// Rigid motion of a patch, the more of it the less the other bones carry it.
HelperSeed seedAt(const SkinningProblem& problem, std::span<const PointWeights> rigWeights,
                  const BoneTracks& bones, std::span<const double> squaredError,
                  std::span<const std::uint32_t> patch) {
  HelperSeed seed;
  seed.point = patch.front();
  double largest = 0;
  for (const std::uint32_t i : patch) {
    largest = std::max(largest, squaredError[i]);
    seed.radius_m =
        std::max(seed.radius_m, (problem.rest_m[i] - problem.rest_m[seed.point]).norm());
  }
  std::vector<double> say;
  say.reserve(patch.size());
  for (const std::uint32_t i : patch) say.push_back(largest > 0 ? squaredError[i] / largest : 1.0);
  seed.parent = parentOf(problem, rigWeights, bones, patch, say);
  const std::span<const Transform> like = bones.track(static_cast<std::size_t>(seed.parent));
  for (std::size_t f = 0; f < problem.frameCount; ++f) {
    RigidFit fit(problem.rest_m[seed.point]);
    for (std::size_t p = 0; p < patch.size(); ++p) {
      const double root = std::sqrt(say[p]);
      fit.add(problem.rest_m[patch[p]], root, root * problem.target(patch[p], f).cast<double>());
    }
    seed.track.push_back(fit.solve(like[f]));
  }
  return seed;
}

}  // namespace

void RigidFit::add(const Vec3& p, double share, const Vec3& target) {
  FASCIA_ASSERT(share >= 0 && p.allFinite() && target.allFinite(), "a point has a share in a bone");
  const Vec3 from = p - origin_m_;
  const double s2 = share * share;
  mass_ += s2;
  spread_ += s2 * from.squaredNorm();
  point_ += s2 * from;
  target_ += share * target;
  correlation_ += (share * from) * target.transpose();
}

Transform RigidFit::solve(const Transform& like) const {
  if (mass_ <= 1e-12) return like;
  const Vec3 from = point_ / mass_;
  const Vec3 to = target_ / mass_;
  const double spread = spread_ - mass_ * from.squaredNorm();
  const Mat3 correlation = correlation_ - (mass_ * from) * to.transpose() +
                           std::max(kLikeness * spread, 1e-30) * like.rotation.transpose();
  const Eigen::JacobiSVD<Mat3> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 turn = svd.matrixV() * svd.matrixU().transpose();
  if (turn.determinant() < 0) {
    Mat3 v = svd.matrixV();
    v.col(2) *= -1;
    turn = v * svd.matrixU().transpose();
  }
  return {turn, to - turn * (from + origin_m_)};
}

void fitHelperMotions(const SkinningProblem& problem, std::span<const PointWeights> weights,
                      std::size_t firstHelper, int sweeps, BoneTracks& bones) {
  const std::vector<std::vector<Use>> uses = usesOf(weights, firstHelper, bones.boneCount());
  std::vector<Vec3> centers(uses.size(), Vec3::Zero());
  for (std::size_t h = 0; h < uses.size(); ++h) {
    if (!uses[h].empty()) centers[h] = centerOf(problem, uses[h]);
  }
  parallelFor(bones.frameCount(), [&](std::size_t f) {
    std::vector<Vec3> left(problem.pointCount());
    for (std::size_t i = 0; i < left.size(); ++i) {
      left[i] =
          problem.target(i, f).cast<double>() - blendPoint(problem.rest_m[i], weights[i], bones, f);
    }
    for (int s = 0; s < sweeps; ++s) {
      sweepFrame(problem, uses, centers, firstHelper, f, left, bones);
    }
  });
}

std::vector<HelperSeed> seedHelpers(const SkinningProblem& problem, const PointGraph& graph,
                                    std::span<const PointWeights> rigWeights,
                                    const BoneTracks& bones, std::span<const double> squaredError,
                                    std::size_t patchSize, std::size_t count,
                                    std::vector<std::uint32_t>& seeds) {
  std::vector<double> score(squaredError.begin(), squaredError.end());
  smoothOnGraph(graph, 6, score);
  for (const std::uint32_t seed : seeds) {
    for (const std::uint32_t i : patchAround(graph, seed, patchSize)) score[i] *= 0.5;
  }
  // One after the other, where the ones before do not reach.
  std::vector<std::vector<std::uint32_t>> patches;
  while (patches.size() < count) {
    const auto worst = std::max_element(score.begin(), score.end());
    if (*worst <= 0) break;
    const auto seed = static_cast<std::uint32_t>(worst - score.begin());
    seeds.push_back(seed);
    patches.push_back(patchAround(graph, seed, patchSize));
    for (const std::uint32_t i : patchAround(graph, seed, 2 * patchSize)) score[i] = 0;
  }
  std::vector<HelperSeed> found(patches.size());
  parallelFor(patches.size(), [&](std::size_t k) {
    found[k] = seedAt(problem, rigWeights, bones, squaredError, patches[k]);
  });
  return found;
}

}  // namespace fascia
