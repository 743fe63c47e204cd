#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// Geometric skinning: points follow the joints by fixed weights, frame by frame, without memory.
class BlendSkinning {
 public:
  virtual ~BlendSkinning() = default;
  virtual std::string_view name() const = 0;  // for people: "linear blend"
  // motion: of every joint, from the bind pose to the frame. Writes all of the model's points.
  // Allocates nothing after the first call.
  virtual void deform(std::span<const Transform> motion, std::span<Eigen::Vector3f> points) = 0;
};

// Motions of all joints from the bind pose to these world frames: world · rest⁻¹.
void restToFrame(const RiggedModel& model, std::span<const Transform> world,
                 std::vector<Transform>& motion);

// The joint with the largest weight of every point.
std::vector<std::uint32_t> dominantJoints(const RiggedModel& model);

// Influences of all points, one after the other, without the unused ones.
struct PackedWeights {
  std::vector<std::uint32_t> first;  // point -> its first influence; one more entry than points
  std::vector<std::uint32_t> joint;
  std::vector<float> weight;

  explicit PackedWeights(std::span<const PointWeights> weights);
};

}  // namespace fascia
