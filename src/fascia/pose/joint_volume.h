#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/pose/joint_motion.h>
#include <fascia/pose/limb_parts.h>
#include <fascia/pose/skin_spread.h>

namespace fascia {

// Flesh keeps its volume: what a bend takes from the inside of a joint comes out around it, least
// where the bone lies just below the skin (after C8 of Cani-Gascuel & Desbrun 1997: local volume
// control). The volume is that of the skin around the joint, seen from it,
//   V = Σ det(x_a - c, x_b - c, x_c - c) / 6,
// and what is missing spreads by a displacement along the normals that is prepared once: a bump
// around the joint, 1 + 0.7 n·in, smoothed as SkinSpread does. Limbs only: around hips and chests
// "the volume of the joint" means too little.
class JointVolume {
 public:
  JointVolume() = default;
  // `keep` per point, 0 … 1: the share that comes back there.
  JointVolume(const PoseSource& source, const PoseMesh& mesh, const LimbParts& parts,
              const SkinSpread& spread, std::span<const float> keep);

  std::size_t jointCount() const { return joints_.size(); }
  // Adds to `along` (per point, along its normal, m) what bent and twisted joints have lost, and
  // takes away what they have gained.
  void restore(std::span<const JointMotion> motion, std::span<const Vector4f> position,
               std::span<float> along) const;

 private:
  struct Reach {
    std::uint32_t point;
    float even;                         // displacement per volume, the same all around
    Eigen::Vector3f byParent, byJoint;  // and per component of `in` in their rest spaces
  };
  struct Joint {
    std::uint32_t joint, parent;
    Vector4f center_m, limbParent, limbJoint;  // unit vectors away from the joint, or zero
    float rest_m3 = 0;
    float total = 0;  // ∫ of the unsmoothed bump, and its parts
    Eigen::Vector3f totalByParent, totalByJoint;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Reach> reach;
  };
  static bool choose(const PoseSource& source, const PoseMesh& mesh, const LimbParts& parts,
                     std::size_t joint, Joint& out, std::vector<float>& bump);
  static void prepare(const PoseSource& source, const PoseMesh& mesh, const SkinSpread& spread,
                      std::span<const float> keep, std::span<const float> bump, Joint& out);

  std::vector<Joint> joints_;
};

}  // namespace fascia
