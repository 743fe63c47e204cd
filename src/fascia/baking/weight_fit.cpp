#include <fascia/baking/weight_fit.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// How far a weight that is wrong by 1 may move its point in every frame before the weak terms give
// in, over the model's size. Ten times more blurs helpers away, ten times less lets noise into
// the weights of joints that the motion hardly moves.
constexpr double kPullOverSize = 5e-4;
// Joints with less than this share of a point do not count as its neighbourhood.
constexpr float kLeastShare = 0.01f;
constexpr std::size_t kPointsPerTask = 64;

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

// Heaviest first; equal ones by bone, so that the order is always the same.
PointWeights packed(std::span<const std::size_t> bones, const CandidateVector& w) {
  std::array<std::pair<double, std::size_t>, kMostNonZero> order;
  std::size_t count = 0;
  double sum = 0;
  for (std::size_t c = 0; c < bones.size() && count < order.size(); ++c) {
    const double weight = w[static_cast<Eigen::Index>(c)];
    if (weight <= 1e-7) continue;
    order[count++] = {-weight, bones[c]};
    sum += weight;
  }
  std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count));
  PointWeights out;
  for (std::size_t k = 0; k < count; ++k) {
    out.joint[k] = static_cast<std::uint16_t>(order[k].second);
    out.weight[k] = static_cast<float>(-order[k].first / sum);
  }
  return out;
}

}  // namespace

WeightFit::WeightFit(const SkinningProblem& problem, const PointGraph& graph,
                     std::span<const PointWeights> rigWeights, const BoneTracks& rigBones,
                     int influences)
    : problem_(problem),
      graph_(graph),
      rig_(rigWeights),
      rigBoneCount_(rigBones.boneCount()),
      influences_(influences),
      stiffness_m2_(std::max(std::pow(kPullOverSize * sizeOf(problem.rest_m), 2), 1e-18)),
      moments_(problem, rigBones) {
  findNearbyJoints();
  findAdjacentJoints();
  findJointOffers();
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

bool WeightFit::mayFollow(std::size_t point, const HelperPlace& helper) const {
  if ((problem_.rest_m[point] - helper.center_m).squaredNorm() > helper.reach_m * helper.reach_m) {
    return false;
  }
  const auto p = static_cast<std::size_t>(helper.parent);
  return std::any_of(nearby_[point].begin(), nearby_[point].end(),
                     [&](std::uint16_t joint) { return adjacent_[joint * rigBoneCount_ + p]; });
}

// What all points of one fit share.
struct WeightFit::Task {
  std::span<const HelperPlace> helpers;
  std::span<const PointWeights> before;

  // The rig's joint that a bone is, or hangs from.
  std::size_t jointOf(std::size_t bone, std::size_t rigBones) const {
    return bone < rigBones ? bone : static_cast<std::size_t>(helpers[bone - rigBones].parent);
  }
};

// What one point needs, one after the other.
struct WeightFit::Scratch {
  Quadratic square{};                      // of the point
  std::vector<double> target;              // around its middle
  double own = 0;                          // squared
  std::vector<Offer> offers;               // those that are taken
  std::vector<std::size_t> bones, joints;  // of these; joints: that helpers hang from
  CandidateMatrix G;
  CandidateVector g, start;

  void goTo(const BoneMoments& moments, std::size_t point, const Eigen::Vector4d& p) {
    square = BoneMoments::squareOf(p);
    moments.target(point, target);
    own = 0;
    for (const double x : target) own += x * x;
  }
};

WeightFit::Offer WeightFit::offerOf(std::size_t bone, const Eigen::Vector4d& p,
                                    const Scratch& scratch) const {
  const double cross = moments_.withTarget(bone, p, scratch.target);
  return {moments_.between(bone, bone, scratch.square) - 2 * cross + scratch.own, cross, bone};
}

void WeightFit::findJointOffers() {
  jointOffers_.resize(rig_.size());
  const std::size_t tasks = (rig_.size() + kPointsPerTask - 1) / kPointsPerTask;
  parallelFor(tasks, [&](std::size_t t) {
    Scratch scratch;
    const std::size_t end = std::min(rig_.size(), (t + 1) * kPointsPerTask);
    for (std::size_t i = t * kPointsPerTask; i < end; ++i) {
      const Eigen::Vector4d p = problem_.rest_m[i].homogeneous();
      scratch.goTo(moments_, i, p);
      for (const std::uint16_t joint : nearby_[i])
        jointOffers_[i].push_back(offerOf(joint, p, scratch));
    }
  });
}

void WeightFit::fit(const BoneTracks& bones, std::span<const HelperPlace> helpers,
                    std::vector<PointWeights>& weights) {
  moments_.update(bones);
  // All from the weights before, so that the order of points does not matter.
  const std::vector<PointWeights> before = weights;
  const Task task{helpers, before};
  const std::size_t tasks = (weights.size() + kPointsPerTask - 1) / kPointsPerTask;
  parallelFor(tasks, [&](std::size_t t) {
    Scratch scratch;
    const std::size_t end = std::min(weights.size(), (t + 1) * kPointsPerTask);
    for (std::size_t i = t * kPointsPerTask; i < end; ++i) {
      weights[i] = fitPoint(task, i, scratch);
    }
  });
}

// At most kMostCandidates bones: those that the point follows now, then those that carry it best by
// themselves.
void WeightFit::offerBones(const Task& task, std::size_t point, Scratch& scratch) const {
  const Eigen::Vector4d p = problem_.rest_m[point].homogeneous();
  scratch.goTo(moments_, point, p);
  scratch.offers = jointOffers_[point];
  for (std::size_t h = 0; h < task.helpers.size(); ++h) {
    if (mayFollow(point, task.helpers[h]))
      scratch.offers.push_back(offerOf(rigBoneCount_ + h, p, scratch));
  }
  for (Offer& offer : scratch.offers) {
    if (weightOf(task.before[point], offer.bone) > 0) offer.error = -1;
  }
  std::sort(scratch.offers.begin(), scratch.offers.end(), [](const auto& a, const auto& b) {
    return std::pair(a.error, a.bone) < std::pair(b.error, b.bone);
  });
  scratch.offers.resize(std::min(scratch.offers.size(), static_cast<std::size_t>(kMostCandidates)));
}

// ½ |D w|² with a column T p - x per candidate: as the weights sum to one, that is half the squared
// error.
PointWeights WeightFit::fitPoint(const Task& task, std::size_t point, Scratch& scratch) const {
  offerBones(task, point, scratch);
  const auto count = static_cast<Eigen::Index>(scratch.offers.size());
  const double stiffness = static_cast<double>(problem_.frameCount) * stiffness_m2_;
  scratch.G.resize(count, count);
  scratch.g = scratch.start = CandidateVector::Zero(count);
  scratch.bones.clear();
  scratch.joints.clear();
  for (Eigen::Index a = 0; a < count; ++a) {
    const Offer& left = scratch.offers[static_cast<std::size_t>(a)];
    scratch.bones.push_back(left.bone);
    scratch.joints.push_back(task.jointOf(left.bone, rigBoneCount_));
    scratch.start[a] = weightOf(task.before[point], left.bone);
    for (Eigen::Index b = 0; b <= a; ++b) {
      const auto other = static_cast<std::size_t>(b);
      const Offer& right = scratch.offers[other];
      const double product = moments_.between(left.bone, right.bone, scratch.square);
      const double shared = scratch.joints[other] == scratch.joints.back() ? stiffness : 0;
      scratch.G(a, b) = scratch.G(b, a) =
          product - left.withTarget - right.withTarget + scratch.own + shared;
    }
    // ½ λ Σ_j (Σ w of joint j and its helpers - rig's weight of j)².
    scratch.g[a] = stiffness * weightOf(rig_[point], scratch.joints.back());
  }
  addNeighborTerm(task, point, scratch);
  return packed(scratch.bones, solveOnSimplex(scratch.G, scratch.g, influences_, scratch.start));
}

// ½ λ |w - w̄|², w̄ the mean of the neighbours' weights; the point's own where it has none.
void WeightFit::addNeighborTerm(const Task& task, std::size_t point, Scratch& scratch) const {
  const double lambda = static_cast<double>(problem_.frameCount) * stiffness_m2_;
  const std::span<const std::uint32_t> around = graph_.neighbors(point);
  for (std::size_t c = 0; c < scratch.bones.size(); ++c) {
    const std::size_t bone = scratch.bones[c];
    double mean = 0;
    for (const std::uint32_t j : around) mean += weightOf(task.before[j], bone);
    mean = around.empty() ? weightOf(task.before[point], bone)
                          : mean / static_cast<double>(around.size());
    const auto k = static_cast<Eigen::Index>(c);
    scratch.G(k, k) += lambda;
    scratch.g[k] += lambda * mean;
  }
}

}  // namespace fascia
