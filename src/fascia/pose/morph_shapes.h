#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/pose/joint_motion.h>
#include <fascia/pose/pose_mesh.h>

namespace fascia {

// Morph targets of the skin: each moves some points of the rest shape by its weight. They turn with
// their points, and stages after this one find the skin where they have put it.
class MorphShapes {
 public:
  MorphShapes() = default;
  MorphShapes(const PoseSource& source, std::size_t pointCount);

  std::size_t size() const { return rest_.size(); }
  // x += R Σ (w − w at rest) d of each point. `weights`: one per morph, or none: all at rest.
  void move(std::span<const double> weights, std::span<const WideRotation> rotation,
            std::span<Vector4f> position) const;

 private:
  struct Share {
    std::uint32_t morph;
    Vector4f displacement_m;  // for a weight of 1
  };
  std::vector<double> rest_;               // per morph
  std::vector<std::uint32_t> points_;      // that any morph moves
  std::vector<std::uint32_t> firstShare_;  // per entry of points_, one more at the end
  std::vector<Share> shares_;              // by point, then morph
};

}  // namespace fascia
