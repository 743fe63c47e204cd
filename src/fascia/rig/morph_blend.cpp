#include <fascia/rig/morph_blend.h>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

Mat3 blendedTurn(const PointWeights& weights, std::span<const Transform> motion) {
  Mat3 turn = Mat3::Zero();
  for (std::size_t k = 0; k < PointWeights::kMost && weights.weight[k] > 0; ++k)
    turn += double{weights.weight[k]} * motion[weights.joint[k]].rotation;
  return turn;
}

}  // namespace

void addMorphs(const RiggedModel& model, std::span<const double> weights,
               std::span<const Transform> motion, double share, std::span<Eigen::Vector3f> points) {
  FASCIA_ASSERT(weights.size() == model.morphs.size(), "a weight for each morph");
  FASCIA_ASSERT(points.size() == model.points_m.size(), "a place for each point");
  for (std::size_t m = 0; m < weights.size(); ++m) {
    const RigMorph& morph = model.morphs[m];
    const double weight = share * (weights[m] - double{morph.rest});
    if (weight == 0) continue;
    for (std::size_t k = 0; k < morph.points.size(); ++k) {
      const std::uint32_t p = morph.points[k];
      const Vec3 moved =
          blendedTurn(model.weights[p], motion) * morph.displacement_m[k].cast<double>();
      points[p] += (weight * moved).cast<float>();
    }
  }
}

}  // namespace fascia
