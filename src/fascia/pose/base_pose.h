#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/pose/joint_motion.h>
#include <fascia/pose/pose_mesh.h>

namespace fascia {

// The first stage: where joints carry the skin when nothing touches and nothing is elastic.
// Centres of rotation (Le & Hodgins 2016, "Real-time skeletal skinning with optimized centers of
// rotation"): the rotation of a point is the normalised blend of its joints' quaternions,
//   q_i = normalise Σ ± w_ij q_j   (each in the half space of the heaviest),
// and the translation that of the linear blend at a centre of rotation p*_i,
//   b_i = Σ w_ij M_j p*_i + R(q_i) (X_i - p*_i),
// so that nothing collapses in a bend or twists shut. The centre is the mean of the surface
// weighted by the similarity of weights (their equation 1); changed: their Gaussian is a polynomial
// of compact support, and only points' own triangles of common joint pairs are visited.
class BasePose {
 public:
  BasePose() = default;
  BasePose(const PoseSource& source, const PoseMesh& mesh);

  std::size_t size() const { return rest_.size(); }
  // Writes position, turn (quaternion) and rotation of the points [begin, end).
  void place(std::span<const JointMotion> joints, std::size_t begin, std::size_t end,
             std::span<Vector4f> position, std::span<Vector4f> turn,
             std::span<WideRotation> rotation) const;
  std::span<const Vector4f> rest() const { return rest_; }

 private:
  struct Influence {
    std::uint32_t joint;
    float weight;
  };
  FrameArray rest_, center_;                   // per point
  std::vector<std::uint32_t> firstInfluence_;  // per point, one more at the end
  std::vector<Influence> influences_;          // heaviest first
};

}  // namespace fascia
