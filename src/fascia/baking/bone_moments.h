#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include <fascia/baking/bone_kernels.h>
#include <fascia/baking/bone_tracks.h>

namespace fascia {

// What bones do to any point, summed over all frames: with p̃ = (p, 1) and T a bone's 3 × 4 matrix,
// Σ (T_a p̃)·(T_b p̃) = p̃ᵀ (Σ T_aᵀ T_b) p̃. The sum in the middle does not depend on the point, and so
// the normal equations of a point's weights cost a few products, however many frames there are.
// Frames are taken around the middle of their targets, so that no digits go where a figure walks
// off; as weights sum to one, that changes no error.
class BoneMoments {
 public:
  // The rig's bones, which stay as they are.
  BoneMoments(const SkinningProblem& problem, const BoneTracks& rigBones);
  // Takes the helpers, which come after the rig's bones, as they move now.
  void update(const BoneTracks& bones);

  std::size_t frameCount() const { return frames_; }
  // A point's targets in all frames, around their middles: what withTarget() takes.
  void target(std::size_t point, std::vector<double>& out) const;
  // Σ (T p̃)·x over frames.
  double withTarget(std::size_t bone, const Eigen::Vector4d& p,
                    const std::vector<double>& target) const;
  // p̃ p̃ᵀ, as between() takes it.
  static Quadratic squareOf(const Eigen::Vector4d& p);
  // Σ (T_a p̃)·(T_b p̃) over frames.
  double between(std::size_t a, std::size_t b, const Quadratic& p) const;

 private:
  // Where the product of two bones is; a ≤ b.
  static std::size_t pairOf(std::size_t a, std::size_t b) { return b * (b + 1) / 2 + a; }
  double* bone(std::size_t b) { return stacked_.data() + 4 * rows_ * b; }
  const double* bone(std::size_t b) const { return stacked_.data() + 4 * rows_ * b; }
  void stack(const BoneTracks& bones, std::size_t first);

  const SkinningProblem& problem_;
  std::size_t frames_, rows_;  // rows: 3 frames, padded
  std::size_t rigBoneCount_;
  std::vector<double> middle_m_;  // rows
  std::vector<double> stacked_;   // rows x 4 bones, column by column
  std::vector<Quadratic> pairs_;
};

}  // namespace fascia
