#include <fascia/baking/weight_fit.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <fascia/baking/simplex_least_squares.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// How far a weight that is wrong by 1 may move its point in every frame before the weak terms give
// in, over the model's size. Ten times more blurs helpers away, ten times less lets noise into
// the weights of joints that the motion hardly moves.
constexpr double kPullOverSize = 5e-4;
// Joints with less than this share of a point do not count as its neighbourhood.
constexpr float kLeastShare = 0.01f;

double weightOf(const PointWeights& weights, std::size_t bone) {
  for (std::size_t k = 0; k < PointWeights::kMost && weights.weight[k] > 0; ++k) {
    if (weights.joint[k] == bone) return static_cast<double>(weights.weight[k]);
  }
  return 0;
}

template <class Visit>
void forEachShare(const PointWeights& weights, const Visit& visit) {
  for (std::size_t k = 0; k < PointWeights::kMost && weights.weight[k] > 0; ++k) {
    if (weights.weight[k] >= kLeastShare) visit(weights.joint[k]);
  }
}

template <class T>
void sortUnique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

double sizeOf(const std::vector<Vec3>& points) {
  Box box;
  for (const Vec3& p : points) box.add(p);
  return box.empty() ? 0 : box.size().norm();
}

// Heaviest first; equal ones by bone, so that the order is always the same.
PointWeights packed(const std::vector<std::size_t>& bones, const CandidateVector& w) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t c = 0; c < bones.size(); ++c) {
    const double weight = w[static_cast<Eigen::Index>(c)];
    if (weight > 1e-7) order.emplace_back(-weight, bones[c]);
  }
  std::sort(order.begin(), order.end());
  double sum = 0;
  for (const auto& [negative, bone] : order) sum -= negative;
  PointWeights out;
  for (std::size_t k = 0; k < order.size(); ++k) {
    out.joint[k] = static_cast<std::uint16_t>(order[k].second);
    out.weight[k] = static_cast<float>(-order[k].first / sum);
  }
  return out;
}

}  // namespace

WeightFit::WeightFit(const SkinningProblem& problem, const PointGraph& graph,
                     std::span<const PointWeights> rigWeights, std::size_t rigBoneCount,
                     int influences)
    : problem_(problem),
      graph_(graph),
      rig_(rigWeights),
      rigBoneCount_(rigBoneCount),
      influences_(influences),
      stiffness_m2_(std::max(std::pow(kPullOverSize * sizeOf(problem.rest_m), 2), 1e-18)) {
  findNearbyJoints();
  findAdjacentJoints();
}

void WeightFit::findNearbyJoints() {
  nearby_.resize(rig_.size());
  parallelFor(rig_.size(), [&](std::size_t i) {
    std::vector<std::uint16_t>& joints = nearby_[i];
    const auto add = [&](std::uint16_t joint) { joints.push_back(joint); };
    forEachShare(rig_[i], add);
    for (const std::uint32_t j : graph_.neighbors(i)) {
      forEachShare(rig_[j], add);
      for (const std::uint32_t k : graph_.neighbors(j)) forEachShare(rig_[k], add);
    }
    if (joints.empty()) joints.push_back(0);
    sortUnique(joints);
  });
}

void WeightFit::findAdjacentJoints() {
  adjacent_.assign(rigBoneCount_ * rigBoneCount_, false);
  for (const std::vector<std::uint16_t>& joints : nearby_) {
    for (const std::uint16_t a : joints) {
      for (const std::uint16_t b : joints) adjacent_[a * rigBoneCount_ + b] = true;
    }
  }
}

bool WeightFit::mayFollow(std::size_t point, int parent) const {
  const auto p = static_cast<std::size_t>(parent);
  return std::any_of(nearby_[point].begin(), nearby_[point].end(),
                     [&](std::uint16_t joint) { return adjacent_[joint * rigBoneCount_ + p]; });
}

void WeightFit::fit(const BoneTracks& bones, std::span<const int> parents,
                    std::span<const std::uint32_t> points,
                    std::vector<PointWeights>& weights) const {
  // All from the weights before, so that the order of points does not matter.
  std::vector<PointWeights> found(points.size());
  parallelFor(points.size(),
              [&](std::size_t k) { found[k] = fitPoint(bones, parents, points[k], weights); });
  for (std::size_t k = 0; k < points.size(); ++k) weights[points[k]] = found[k];
}

std::vector<std::size_t> WeightFit::candidates(const BoneTracks& bones,
                                               std::span<const int> parents,
                                               std::size_t point) const {
  std::vector<std::pair<double, std::size_t>> order;
  const auto offer = [&](std::size_t bone) {
    double error = 0;
    for (std::size_t f = 0; f < problem_.frameCount; ++f) {
      error += (bones.at(bone, f).point(problem_.rest_m[point]) -
                problem_.target(point, f).cast<double>())
                   .squaredNorm();
    }
    order.emplace_back(error, bone);
  };
  for (const std::uint16_t joint : nearby_[point]) offer(joint);
  for (std::size_t h = 0; h < parents.size(); ++h) {
    if (mayFollow(point, parents[h])) offer(rigBoneCount_ + h);
  }
  std::sort(order.begin(), order.end());
  std::vector<std::size_t> out;
  for (const auto& [error, bone] : order) {
    if (out.size() < static_cast<std::size_t>(kMostCandidates)) out.push_back(bone);
  }
  return out;
}

// ½ |D w|² with a column T p - x per candidate: as the weights sum to one, that is half the squared
// error. It keeps the digits that the usual normal equations lose, as bones move alike.
PointWeights WeightFit::fitPoint(const BoneTracks& bones, std::span<const int> parents,
                                 std::size_t point, std::span<const PointWeights> before) const {
  const std::vector<std::size_t> offered = candidates(bones, parents, point);
  const auto count = static_cast<Eigen::Index>(offered.size());
  const auto frames = static_cast<Eigen::Index>(problem_.frameCount);
  Eigen::MatrixXd D(3 * frames, count);
  for (Eigen::Index c = 0; c < count; ++c) {
    const std::span<const Transform> track = bones.track(offered[static_cast<std::size_t>(c)]);
    for (Eigen::Index f = 0; f < frames; ++f) {
      const auto frame = static_cast<std::size_t>(f);
      D.col(c).segment<3>(3 * f) =
          track[frame].point(problem_.rest_m[point]) - problem_.target(point, frame).cast<double>();
    }
  }
  CandidateMatrix G = D.transpose() * D;
  CandidateVector g = CandidateVector::Zero(count);
  addNeighborTerm(offered, point, before, G, g);
  addRigTerm(offered, parents, point, G, g);
  return packed(offered, solveOnSimplex(G, g, influences_));
}

// ½ λ |w - w̄|², w̄ the mean of the neighbours' weights; the point's own where it has none.
void WeightFit::addNeighborTerm(std::span<const std::size_t> offered, std::size_t point,
                                std::span<const PointWeights> before, CandidateMatrix& G,
                                CandidateVector& g) const {
  const double lambda = static_cast<double>(problem_.frameCount) * stiffness_m2_;
  const std::span<const std::uint32_t> around = graph_.neighbors(point);
  for (std::size_t c = 0; c < offered.size(); ++c) {
    double mean = 0;
    for (const std::uint32_t j : around) mean += weightOf(before[j], offered[c]);
    mean = around.empty() ? weightOf(before[point], offered[c])
                          : mean / static_cast<double>(around.size());
    const auto k = static_cast<Eigen::Index>(c);
    G(k, k) += lambda;
    g[k] += lambda * mean;
  }
}

// ½ λ Σ_j (Σ w of joint j and its helpers - rig's weight of j)².
void WeightFit::addRigTerm(std::span<const std::size_t> offered, std::span<const int> parents,
                           std::size_t point, CandidateMatrix& G, CandidateVector& g) const {
  const double lambda = static_cast<double>(problem_.frameCount) * stiffness_m2_;
  const auto jointOf = [&](std::size_t bone) {
    return bone < rigBoneCount_ ? bone : static_cast<std::size_t>(parents[bone - rigBoneCount_]);
  };
  for (std::size_t a = 0; a < offered.size(); ++a) {
    const std::size_t joint = jointOf(offered[a]);
    const auto r = static_cast<Eigen::Index>(a);
    g[r] += lambda * weightOf(rig_[point], joint);
    for (std::size_t b = 0; b < offered.size(); ++b) {
      if (jointOf(offered[b]) == joint) G(r, static_cast<Eigen::Index>(b)) += lambda;
    }
  }
}

}  // namespace fascia
