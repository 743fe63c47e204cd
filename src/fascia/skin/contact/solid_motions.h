#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <fascia/field/field.h>
#include <fascia/skin/point/point_kernels.h>

namespace fascia {

// How solids have moved since they were last looked at, as affine maps. Tells how far what was
// known of gaps still holds, so that solids that cannot have come within reach are not asked again.
class SolidMotions {
 public:
  // Gap of what has not been tested yet: nothing is known.
  static constexpr float kUnknown = -1e30f;

  // Follows the solids to where they are now. False: these are other solids, or the first ones;
  // then nothing is known of any gap.
  bool follow(const MovingField& field);
  std::size_t size() const { return motions_.size(); }

  // What is left of a gap between a block of points and a solid since the last call but one. Holds
  // for everything between the points, too.
  float left(float gap_m, const BlockMotion& block, std::size_t solid) const;

 private:
  static constexpr std::size_t kCorners = MovingField::kOutline;

  // x goes by change (x − origin) + shift.
  struct Motion {
    Eigen::Matrix3f change;
    Eigen::Vector3f origin, shift;
    float turn;           // norm of change
    float extra_m;        // what is not rigid: swelling and bending
    float steepness = 1;  // the field's Lipschitz bound: how much a way can change distances
  };
  static Motion between(std::span<const Eigen::Vector3f, kCorners> before,
                        std::span<const Eigen::Vector3f, kCorners> now);

  std::vector<Motion> motions_;
  std::vector<Eigen::Vector3f> corners_;  // of each solid's outline
};

}  // namespace fascia
