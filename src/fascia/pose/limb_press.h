#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <fascia/pose/joint_motion.h>
#include <fascia/pose/limb_parts.h>

namespace fascia {

// Limbs that share no crease (a hand on a thigh, thigh on thigh, an arm on a belly): flesh gives
// way under what presses on it. With f the body of a soft limb B, i a skin point of another limb A,
// and j one of B's own skin, j sinks towards B's bone by
//   max_i  g_i s_ij k(d_ij) (f(x_j) - f(x_i) + margin),
// d_ij the distance of i from where j would come to, k = 1 over the mesh's edges and fading farther
// out: the points of A are a height field over B that B's skin comes to lie below. The maximum of
// smooth functions changes without jumps. How the two share a depth (s) follows from how soft they
// are. Limbs that are driven deep into another are the motion's business: a contact lets go as a
// whole (g). What touches at rest stays as it is.
class LimbPress {
 public:
  struct Touch {
    Eigen::Vector3f at;  // in B's rest space
    float height_m, gate, soft;
    std::uint32_t joint;  // A
  };
  struct FourTouches {
    Eigen::Array4f x, y, z, height_m, gate, soft;
  };
  // Of one frame.
  struct Scratch {
    struct OfLimb {
      std::vector<Touch> touches;
      std::vector<float> depth_m, around_m;        // per joint
      std::vector<std::vector<FourTouches>> near;  // per patch
    };
    std::vector<OfLimb> limbs;
  };

  LimbPress() = default;
  // `softness` per point, 0 … 1; 0 never gives way.
  LimbPress(const PoseSource& source, const PoseMesh& mesh, std::shared_ptr<const LimbParts> parts,
            std::span<const float> softness);

  std::size_t limbCount() const { return limbs_.size(); }
  void press(std::span<const JointMotion> motion, std::span<Vector4f> position,
             Scratch& scratch) const;

 private:
  // A cluster of another limb's skin, not much denser than B's; without what touches B at rest.
  struct Presser {
    std::uint32_t joint;
    Vector4f middle;  // at rest
    float radius_m;   // of the cluster, with room for what the pose deforms
    std::vector<std::uint32_t> points;
    std::vector<float> clear;  // 0 touches at rest … 1
  };
  // A cluster of skin that gives way.
  struct Patch {
    Eigen::AlignedBox3f box;  // at rest, with room for what the pose deforms
    std::vector<std::uint32_t> points;
    std::vector<float> share;  // 1 on the limb, fading beyond its ends
  };
  struct Limb {
    std::uint32_t joint;
    float highest_m;  // of its skin over its body at rest
    float core_m;     // length of its edges
    std::vector<Patch> patches;
    std::vector<Presser> pressers;
  };
  void addPatches(const PoseMesh& mesh, Limb& limb) const;
  void addPressers(const PoseMesh& mesh, std::uint32_t joint, Limb& limb) const;
  void findTouches(const Limb& limb, std::span<const JointMotion> motion,
                   std::span<const Vector4f> position, Scratch::OfLimb& found) const;
  void letGo(const Limb& limb, Scratch::OfLimb& found) const;
  void giveWay(const Limb& limb, const JointMotion& own, std::span<Vector4f> position,
               Scratch::OfLimb& found) const;
  struct Place {  // of a point, in B's rest space
    Eigen::Vector3f at, away;
    float height_m, fromBone_m;
  };
  float sinkOf(const Limb& limb, std::span<const FourTouches> touches, std::uint32_t point,
               float fade_m, const Place& place) const;

  std::shared_ptr<const LimbParts> parts_;
  std::vector<float> softness_;
  std::vector<int> above_;  // per joint: the next one towards the root that has a body, or -1
  std::vector<Limb> limbs_;
};

}  // namespace fascia
