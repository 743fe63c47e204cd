#pragma once

#include <span>
#include <vector>

#include <fascia/baking/skinning_decomposition.h>

namespace fascia {

// The affine map by which linear blend skinning moves a point: p ↦ linear p + offset_m.
struct BlendedMatrix {
  Mat3 linear = Mat3::Zero();
  Vec3 offset_m = Vec3::Zero();

  Vec3 point(const Vec3& p) const { return linear * p + offset_m; }
};
BlendedMatrix blendBones(const PointWeights& weights, std::span<const Transform> bones);

// The displacement d in the bind pose that brings a point nearest to its target: M (p + d) = x.
// Where opposite joints cancel and M loses a direction, d stays small in it.
Vec3 bindPoseDisplacement(const BlendedMatrix& blend, const Vec3& rest, const Vec3& target);

}  // namespace fascia
