#include <fascia/baking/helper_seeds.h>

#include <algorithm>
#include <map>

#include <fascia/baking/rigid_fit.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

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
  const Vec3& origin = problem.rest_m[seed.point];
  for (std::size_t f = 0; f < problem.frameCount; ++f) {
    RigidSums sums;
    for (std::size_t p = 0; p < patch.size(); ++p) {
      const Vec3 q = problem.rest_m[patch[p]] - origin;
      const Vec3 x = problem.target(patch[p], f).cast<double>();
      sums.mass += say[p];
      sums.spread += say[p] * q.squaredNorm();
      sums.point += say[p] * q;
      sums.target += say[p] * x;
      sums.correlation += (say[p] * q) * x.transpose();
    }
    seed.track.push_back(fitRigidly(sums, origin, like[f]));
  }
  return seed;
}

}  // namespace

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
