#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/skin/joint_carrier.h>

namespace fascia {

// Flesh that a bending joint would lose bulges out around it (after Rohmer, Hahmann & Cani 2009,
// "Exact volume preserving skinning with shape control"). Around every joint, the surface whose
// points hang on both of its sides encloses a volume; what a pose takes of that is given back by
// moving those points out along their normals,
//
//   d_p = λ w_p n_p,   λ = (V0 − V) / Σ A_p w_p,
//
// w_p a bell over the joint that leaves out the inner side of a bend, where two sides meet; n_p the
// rest normal as the joint and its parent turn it, which is steady also where the surface folds. In
// the rest posture nothing moves, and nothing where a pose gains volume: that is mostly a twist
// that opens folds.
class JointVolume {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  JointVolume() = default;
  // Points and triangles by storage index; `rest` is where the rest posture puts the points.
  JointVolume(std::span<const JointCarrier::Joint> joints,
              std::span<const JointCarrier::Point> points, std::span<const Triangle> triangles,
              const VectorArray& rest);

  bool empty() const { return regions_.empty(); }
  std::size_t regionCount() const { return regions_.size(); }

  // Scratch memory of one caller.
  struct Scratch {
    std::vector<Eigen::Vector3f> place, area;  // per region and point
  };
  // Gives back the share in [0, 1] of what is lost. `place` holds the points where joints carry
  // them, `motion` how these have moved (see JointCarrier::place).
  void restore(float share, std::span<const JointCarrier::Motion> motion, Scratch& scratch,
               VectorArray& place) const;

 private:
  // One joint's surroundings. Local points are its own ones, then the middles of its open rims.
  struct Region {
    std::size_t joint, parent;            // entries of the carrier's joints
    std::size_t first;                    // of its local points in the scratch memory
    std::vector<std::uint32_t> points;    // storage indices, ascending
    std::vector<float> bell;              // per point, in [0, 1]; 0 on the rim
    std::vector<float> side;              // per point: 1 hangs on the joint, −1 on its parent
    std::vector<Eigen::Vector3f> normal;  // per point: at rest
    std::vector<std::vector<std::uint32_t>> rims;  // local points
    std::vector<Triangle> triangles;               // of local points
    float volume_m3 = 0, longest_m = 0;            // V0; of the ways out
  };
  void addRegion(std::size_t joint, std::size_t parent, std::span<const float> shares,
                 std::span<const Triangle> triangles);
  void closeRims(Region& region) const;
  static float gather(const Region& region, const VectorArray& place, Scratch& scratch);
  static void moveOut(const Region& region, std::span<const JointCarrier::Motion> motion,
                      float missing_m3, Scratch& scratch);

  std::vector<Region> regions_;
  std::size_t localCount_ = 0;
};

}  // namespace fascia
