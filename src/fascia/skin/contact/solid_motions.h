#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include <fascia/field/field.h>
#include <fascia/skin/contact/culled_solids.h>

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
  using Corners = std::array<Eigen::Vector3f, kCorners>;
  struct Solid {
    Transform frame;
    MovingField::Outline outline;  // in the frame
  };

  static CulledSolids::Motion rigid(const Transform& before, const Transform& now,
                                    const MovingField::Outline& outline);
  static CulledSolids::Motion between(const Corners& before, const Corners& now);

  std::vector<Solid> solids_;  // where they were
};

}  // namespace fascia
