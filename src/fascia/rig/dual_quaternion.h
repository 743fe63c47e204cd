#pragma once

#include <fascia/rig/blend_skinning.h>

namespace fascia {

// Dual quaternion skinning (Kavan, Collins, Žára & O'Sullivan 2008, "Geometric Skinning with
// Approximate Dual Quaternion Blending"): blends rigid motions to rigid motions, so that joints do
// not collapse; they bulge instead.
class DualQuaternionBlend : public BlendSkinning {
 public:
  explicit DualQuaternionBlend(const RiggedModel& model);
  std::string_view name() const override { return "dual quaternions"; }
  void deform(std::span<const Transform> motion, std::span<Eigen::Vector3f> points) override;

 private:
  // q = real + ε dual, coefficients x, y, z, w.
  struct DualQuaternion {
    Eigen::Vector4f real, dual;
  };

  PackedWeights weights_;
  std::vector<Eigen::Vector3f> rest_;
  std::vector<DualQuaternion> motion_;  // per joint, of the frame at hand
};

}  // namespace fascia
