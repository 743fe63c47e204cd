#pragma once

#include <fascia/rig/blend_skinning.h>

namespace fascia {

// Linear blend skinning (Magnenat-Thalmann et al. 1988): p' = Σ w_i M_i p. Every game engine's.
class LinearBlend : public BlendSkinning {
 public:
  explicit LinearBlend(const RiggedModel& model);
  std::string_view name() const override { return "linear blend"; }
  void deform(std::span<const Transform> motion, std::span<Eigen::Vector3f> points) override;

 private:
  using Matrix = Eigen::Matrix4f;  // columns are what SIMD registers hold

  PackedWeights weights_;
  std::vector<Eigen::Vector3f> rest_;
  std::vector<Matrix> matrices_;  // per joint, of the frame at hand
};

}  // namespace fascia
