#include <fascia/baking/blended_frames.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

// A blend that shrinks a direction below this is not turned round exactly: a displacement of 1 mm
// in the world would need more than 1 / kLeastStretch mm in the bind pose, and ruin other frames.
constexpr double kLeastStretch = 0.2;

}  // namespace

BlendedMatrix blendBones(const PointWeights& weights, std::span<const Transform> bones) {
  FASCIA_ASSERT(!bones.empty(), "there are bones");
  BlendedMatrix out;
  for (std::size_t k = 0; k < PointWeights::kMost && weights.weight[k] > 0; ++k) {
    const auto w = static_cast<double>(weights.weight[k]);
    out.linear += w * bones[weights.joint[k]].rotation;
    out.offset_m += w * bones[weights.joint[k]].translation_m;
  }
  return out;
}

Vec3 bindPoseDisplacement(const BlendedMatrix& blend, const Vec3& rest, const Vec3& target) {
  const Vec3 missing = target - blend.point(rest);
  const Mat3 gram = blend.linear.transpose() * blend.linear;
  // |M| ≤ 1 for blends of rotations, so that a small determinant tells of a lost direction.
  if (blend.linear.determinant() > kLeastStretch) return blend.linear.inverse() * missing;
  const Mat3 damped = gram + kLeastStretch * kLeastStretch * Mat3::Identity();
  return damped.ldlt().solve(blend.linear.transpose() * missing);
}

}  // namespace fascia
