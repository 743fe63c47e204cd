#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include <fascia/baking/bone_tracks.h>

namespace fascia {

// Finds how helpers move for given weights, with the points summed out.
//
// A helper's motion is the rigid fit to what the other bones leave of the targets (Le & Deng 2012,
// eqs. 8 to 12). All that the fit needs of the points is Σ w_h q̃ rᵀ, with q̃ = (p − center, 1) and r
// the rest that is left: Σ w_h q̃ xᵀ − Σ_k M_hk T_kᵀ, over the other bones k. M_hk = Σ w_h w_k q̃ q̃ᵀ
// is the same in all frames. So one pass over the points is enough, and sweeps over the helpers
// cost the same for a hundred points as for a hundred thousand.
class HelperMoments {
 public:
  // Helpers are the bones from `firstHelper` on. Where points go by `targetWeights` in every frame,
  // these are given instead of targets: then points are not needed at all after this.
  HelperMoments(std::span<const Vec3> rest, std::span<const PointWeights> weights,
                std::size_t firstHelper, std::size_t boneCount,
                std::span<const PointWeights> targetWeights = {});

  // Refits the helpers' motions in all frames of `bones`, one after the other, until they hardly
  // move, at most `sweeps` times. targets: none if they go by weights.
  void fit(const SkinningProblem* targets, int sweeps, BoneTracks& bones) const;

 private:
  using Moment = Eigen::Matrix4d;                               // Σ w w q̃ q̃ᵀ
  using Sums = Eigen::Matrix<double, 4, 3>;                     // Σ w q̃ xᵀ
  using TargetSums = Eigen::Matrix<double, 4, Eigen::Dynamic>;  // Sums, side by side: 3 per frame
  struct Use {
    std::uint32_t point = 0;
    double weight = 0;
  };
  struct Link {
    std::size_t bone = 0;
    Moment moment;
  };
  struct Helper {
    std::vector<Use> uses;
    Vec3 center_m = Vec3::Zero();
    Moment own = Moment::Zero();
    std::vector<Link> joints, helpers;  // the bones that it shares points with
  };

  void collectUses(std::span<const PointWeights> weights);
  void collectMoments(std::size_t helper, std::span<const Vec3> rest,
                      std::span<const PointWeights> weights,
                      std::span<const PointWeights> targetWeights, std::size_t boneCount);
  TargetSums targetSums(const SkinningProblem& problem, const Helper& helper) const;
  void fitFrame(std::size_t frame, int sweeps, std::vector<Sums>& wanted, BoneTracks& bones) const;
  bool refit(std::size_t helper, std::size_t frame, const Sums& wanted, BoneTracks& bones) const;

  std::span<const Vec3> rest_m_;
  std::size_t firstHelper_;
  double settled_m2_ = 0;
  std::vector<Helper> helpers_;
};

}  // namespace fascia
