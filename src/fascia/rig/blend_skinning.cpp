#include <fascia/rig/blend_skinning.h>

namespace fascia {

void restToFrame(const RiggedModel& model, std::span<const Transform> world,
                 std::vector<Transform>& motion) {
  motion.resize(model.joints.size());
  for (std::size_t j = 0; j < motion.size(); ++j)
    motion[j] = world[j] * model.joints[j].rest_world.inverse();
}

std::vector<std::uint32_t> dominantJoints(const RiggedModel& model) {
  std::vector<std::uint32_t> dominant;
  dominant.reserve(model.weights.size());
  for (const PointWeights& w : model.weights) dominant.push_back(w.joint[0]);  // heaviest first
  return dominant;
}

PackedWeights::PackedWeights(std::span<const PointWeights> weights) {
  first.reserve(weights.size() + 1);
  first.push_back(0);
  for (const PointWeights& w : weights) {
    for (std::size_t k = 0; k < PointWeights::kMost; ++k) {
      if (!(w.weight[k] > 0)) continue;
      joint.push_back(w.joint[k]);
      weight.push_back(w.weight[k]);
    }
    first.push_back(static_cast<std::uint32_t>(joint.size()));
  }
}

}  // namespace fascia
