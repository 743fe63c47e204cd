#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/pose/joint_motion.h>
#include <fascia/pose/limb_parts.h>
#include <fascia/pose/skin_spread.h>

namespace fascia {

// Muscles that show: as a joint bends, the flexors on its inner side swell, on the bone above it
// (biceps, hamstring) and less on its own (calf, forearm), and the extensors on the outer side are
// drawn thin. Which side is which follows from the bend itself,
//   in = u_above + u_own,   unit vectors from the joint along its two bones,
// less what it is at rest: |in| is 0 for a straight limb, 1.4 at a right angle. The displacement
// along the normal is Σ_c in_c φ_c with fields φ that are prepared once: a spindle along the bone,
// times the normal's component c, smoothed as SkinSpread does.
class MuscleSwell {
 public:
  MuscleSwell() = default;
  // `dial` per point: 0 none, 0.3 natural, 1 bodybuilder.
  MuscleSwell(const PoseSource& source, const PoseMesh& mesh, const LimbParts& parts,
              const SkinSpread& spread, std::span<const float> dial);

  // Adds to `along` (per point, along its normal, m).
  void swell(std::span<const JointMotion> motion, std::span<float> along) const;

 private:
  struct Reach {
    std::uint32_t point;
    Eigen::Vector3f per;  // displacement per component of `in` in the bone's rest space
  };
  struct Muscle {  // of one bone at one joint
    std::uint32_t bone, above, joint;
    Vector4f towardsAbove, along;  // the joint's two bones at rest
    Vector4f rest;                 // `in` at rest
    std::vector<Reach> reach;
  };
  static void prepare(const PoseMesh& mesh, const LimbParts& parts, const SkinSpread& spread,
                      std::span<const float> dial, float strength, Muscle& muscle);

  std::vector<Muscle> muscles_;
};

}  // namespace fascia
