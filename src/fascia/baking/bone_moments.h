#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include <fascia/baking/bone_tracks.h>

namespace fascia {

// What bones do to any point, summed over all frames: with p̃ = (p, 1) and T a bone's 3 × 4 matrix,
// Σ (T_a p̃)·(T_b p̃) = p̃ᵀ (Σ T_aᵀ T_b) p̃. The sum in the middle does not depend on the point, and so
// the normal equations of a point's weights cost a few products, however many frames there are.
// Frames are taken around the middle of their targets, so that no digits go where a figure walks
// off; as weights sum to one, that changes no error.
class BoneMoments {
 public:
  BoneMoments(const SkinningProblem& problem, const BoneTracks& bones);

  std::size_t frameCount() const { return frames_; }
  // A point's targets in all frames, around their middles: 3 frames.
  void target(std::size_t point, Eigen::VectorXd& out) const;
  // Σ Tᵀ x over frames.
  Eigen::Vector4d withTarget(std::size_t bone, const Eigen::VectorXd& target) const {
    return stacked_.middleCols<4>(col(bone)).transpose() * target;
  }
  // Σ T_aᵀ T_b over frames.
  auto between(std::size_t a, std::size_t b) const { return gram_.block<4, 4>(col(a), col(b)); }

 private:
  static Eigen::Index col(std::size_t bone) { return 4 * static_cast<Eigen::Index>(bone); }

  const SkinningProblem& problem_;
  std::size_t frames_;
  std::vector<Vec3> middle_m_;  // per frame
  Eigen::MatrixXd stacked_;     // 3 frames x 4 bones
  Eigen::MatrixXd gram_;        // 4 bones x 4 bones
};

}  // namespace fascia
