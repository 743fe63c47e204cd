#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/pose/jiggle_state.h>
#include <fascia/pose/joint_motion.h>
#include <fascia/pose/limb_parts.h>

namespace fascia {

// Flesh that moves by itself: damped oscillators some local radii apart,
//   d̈ + 2 ζ ω ḋ + ω² d = -ẍ of their place on the skin,
// stepped exactly (no step can be too long), and blended along the skin by smooth weights, so that
// no lump can be finer than their spacing (Turner & Gobbetti 1998: fat that bounces). Softness
// follows anatomy: thick flesh, bellies, ears and tails; none on hands, feet, skulls and stiff
// pieces.
class Jiggle {
 public:
  Jiggle() = default;
  // `dial` per point: 0 none, 0.5 as flesh is, 1 jelly.
  Jiggle(const PoseSource& source, const PoseMesh& mesh, const LimbParts& parts,
         std::span<const float> dial);

  std::size_t nodeCount() const { return nodes_.size(); }
  // The state of another figure's jiggle as one of this one's: every place swings on as what was
  // nearest to it there. `rest` and `restBefore`: the points of both at rest. What places have done
  // since is forgotten: an edit is no motion.
  JiggleState carryOver(const JiggleState& state, const Jiggle& before,
                        std::span<const Eigen::Vector3f> rest,
                        std::span<const Eigen::Vector3f> restBefore) const;
  // Advances to a frame dt_s later, where the skin without jiggle is at `position` + `origin_m`.
  void step(double dt_s, std::span<const Vector4f> position, const Vec3& origin_m,
            JiggleState& state) const;
  // `shown` is scratch.
  void add(const JiggleState& state, FrameArray& shown, std::span<Vector4f> position) const;

 private:
  struct Node {
    std::uint32_t point;
    float omega;    // rad/s
    float limit_m;  // offsets approach it, however hard a body is shaken
  };
  struct Share {
    std::uint32_t node;
    float weight;
  };
  void placeNodes(const PoseMesh& mesh, const LimbParts& parts, std::span<const float> softness,
                  std::span<const float> dial, std::vector<std::vector<Share>>& shares);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> points_;      // that move
  std::vector<std::uint32_t> firstShare_;  // per moving point, one more at the end
  std::vector<Share> shares_;
};

}  // namespace fascia
