#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <fascia/field/field.h>
#include <fascia/skin/contact/solid_cull_kernels.h>

namespace fascia {

// How solids have moved since they were last looked at, as affine maps. Tells how far what was
// known of gaps still holds, so that solids that cannot have come within reach are not asked again.
class SolidMotions {
 public:
  // Writes the motions of the solids to where they are now. False: these are other solids, or the
  // first ones; then `solids` has room for them, and nothing is known of any gap.
  bool follow(const MovingField& field, CulledSolids& solids);

 private:
  static constexpr std::size_t kCorners = MovingField::kOutline;

  static CulledSolids::Motion between(std::span<const Eigen::Vector3f, kCorners> before,
                                      std::span<const Eigen::Vector3f, kCorners> now);

  std::vector<Eigen::Vector3f> corners_;  // of each solid's outline
};

}  // namespace fascia
