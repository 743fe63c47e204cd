#include <fascia/baking/helper_moments.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fascia/baking/rigid_fit.h>
#include <fascia/base/parallel.h>

namespace fascia {
namespace {

// Of the model's size: helpers that move by less in a sweep have settled.
constexpr double kSettled = 1e-6;

// A bone's matrix, acting on points that are told from `origin`.
Eigen::Matrix<double, 3, 4> matrixFrom(const Transform& bone, const Vec3& origin_m) {
  Eigen::Matrix<double, 3, 4> out;
  out << bone.rotation, bone.point(origin_m);
  return out;
}

}  // namespace

HelperMoments::HelperMoments(std::span<const Vec3> rest, std::span<const PointWeights> weights,
                             std::size_t firstHelper, std::size_t boneCount,
                             std::span<const PointWeights> targetWeights)
    : rest_m_(rest),
      firstHelper_(firstHelper),
      settled_m2_(std::pow(kSettled * sizeOf(rest), 2)),
      helpers_(boneCount - firstHelper) {
  assert(weights.size() == rest.size());
  assert(targetWeights.empty() || targetWeights.size() == rest.size());
  collectUses(weights);
  parallelFor(helpers_.size(),
              [&](std::size_t h) { collectMoments(h, rest, weights, targetWeights, boneCount); });
}

void HelperMoments::collectUses(std::span<const PointWeights> weights) {
  for (std::size_t i = 0; i < weights.size(); ++i) {
    for (std::size_t k = 0; k < PointWeights::kMost && weights[i].weight[k] > 0; ++k) {
      const std::size_t bone = weights[i].joint[k];
      assert(bone < firstHelper_ + helpers_.size());
      if (bone < firstHelper_) continue;
      helpers_[bone - firstHelper_].uses.push_back(
          {static_cast<std::uint32_t>(i), static_cast<double>(weights[i].weight[k])});
    }
  }
}

void HelperMoments::collectMoments(std::size_t h, std::span<const Vec3> rest,
                                   std::span<const PointWeights> weights,
                                   std::span<const PointWeights> targetWeights,
                                   std::size_t boneCount) {
  Helper& helper = helpers_[h];
  double mass = 0;
  for (const Use& use : helper.uses) {
    helper.center_m += use.weight * rest[use.point];
    mass += use.weight;
  }
  if (mass > 0) helper.center_m /= mass;
  std::vector<Link> links;
  std::vector<std::size_t> linkOf(boneCount, boneCount);
  const auto add = [&](std::size_t bone, double share, const Eigen::Vector4d& q) {
    if (linkOf[bone] == boneCount) {
      linkOf[bone] = links.size();
      links.push_back({bone, Moment::Zero()});
    }
    links[linkOf[bone]].moment += share * q * q.transpose();
  };
  for (const Use& use : helper.uses) {
    const Eigen::Vector4d q = (rest[use.point] - helper.center_m).homogeneous();
    const PointWeights& own = weights[use.point];
    for (std::size_t k = 0; k < PointWeights::kMost && own.weight[k] > 0; ++k) {
      add(own.joint[k], use.weight * static_cast<double>(own.weight[k]), q);
    }
    if (targetWeights.empty()) continue;
    // Where the targets are a sum over bones too, so is what is left of them.
    const PointWeights& wanted = targetWeights[use.point];
    for (std::size_t k = 0; k < PointWeights::kMost && wanted.weight[k] > 0; ++k) {
      add(wanted.joint[k], -use.weight * static_cast<double>(wanted.weight[k]), q);
    }
  }
  for (const Link& link : links) {
    if (link.bone == firstHelper_ + h) {
      helper.own = link.moment;
    } else {
      (link.bone < firstHelper_ ? helper.joints : helper.helpers).push_back(link);
    }
  }
}

HelperMoments::TargetSums HelperMoments::targetSums(const SkinningProblem& problem,
                                                    const Helper& helper) const {
  const auto columns = 3 * static_cast<Eigen::Index>(problem.frameCount);
  TargetSums sums = TargetSums::Zero(4, columns);
  for (const Use& use : helper.uses) {
    const Eigen::Vector4d q = use.weight * (rest_m_[use.point] - helper.center_m).homogeneous();
    const Eigen::Map<const Eigen::RowVectorXf> x(problem.target(use.point, 0).data(), columns);
    sums.noalias() += q * x.cast<double>();
  }
  return sums;
}

void HelperMoments::fit(const SkinningProblem* targets, int sweeps, BoneTracks& bones) const {
  assert(!targets || targets->frameCount == bones.frameCount());
  assert(bones.boneCount() == firstHelper_ + helpers_.size());
  std::vector<TargetSums> sums(targets ? helpers_.size() : 0);
  parallelFor(sums.size(), [&](std::size_t h) { sums[h] = targetSums(*targets, helpers_[h]); });
  parallelFor(bones.frameCount(), [&](std::size_t f) {
    std::vector<Sums> wanted(helpers_.size(), Sums::Zero());
    for (std::size_t h = 0; h < sums.size(); ++h) {
      wanted[h] = sums[h].middleCols<3>(3 * static_cast<Eigen::Index>(f));
    }
    fitFrame(f, sweeps, wanted, bones);
  });
}

// Gauss–Seidel over the helpers. The rig's joints stay: what they take is taken out once.
void HelperMoments::fitFrame(std::size_t frame, int sweeps, std::vector<Sums>& wanted,
                             BoneTracks& bones) const {
  for (std::size_t h = 0; h < helpers_.size(); ++h) {
    for (const Link& link : helpers_[h].joints) {
      const auto matrix = matrixFrom(bones.at(link.bone, frame), helpers_[h].center_m);
      wanted[h].noalias() -= link.moment * matrix.transpose();
    }
  }
  // A helper whose neighbours have hardly moved since it was fitted stays where it is.
  std::vector<char> due(helpers_.size());
  for (std::size_t h = 0; h < helpers_.size(); ++h) due[h] = helpers_[h].uses.empty() ? 0 : 1;
  for (int s = 0; s < sweeps; ++s) {
    bool moved = false;
    for (std::size_t h = 0; h < helpers_.size(); ++h) {
      if (!due[h]) continue;
      due[h] = 0;
      if (!refit(h, frame, wanted[h], bones)) continue;
      for (const Link& link : helpers_[h].helpers) due[link.bone - firstHelper_] = 1;
      moved = true;
    }
    if (!moved) break;
  }
}

// Whether it moved by more than what settled helpers do.
bool HelperMoments::refit(std::size_t h, std::size_t frame, const Sums& wanted,
                          BoneTracks& bones) const {
  const Helper& helper = helpers_[h];
  Sums left = wanted;
  for (const Link& link : helper.helpers) {
    const auto matrix = matrixFrom(bones.at(link.bone, frame), helper.center_m);
    left.noalias() -= link.moment * matrix.transpose();
  }
  RigidSums sums;
  sums.mass = helper.own(3, 3);
  sums.spread = helper.own.diagonal().head<3>().sum();
  sums.point = helper.own.col(3).head<3>();
  sums.target = left.row(3);
  sums.correlation = left.topRows<3>();
  Transform& bone = bones.track(firstHelper_ + h)[frame];
  const Transform before = bone;
  bone = fitRigidly(sums, helper.center_m, before);
  if (sums.mass <= 0) return false;
  const double turned2 = (bone.rotation - before.rotation).squaredNorm() * sums.spread / sums.mass;
  const double shifted2 =
      (bone.point(helper.center_m) - before.point(helper.center_m)).squaredNorm();
  return turned2 + shifted2 > settled_m2_;
}

}  // namespace fascia
