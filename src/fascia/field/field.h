#pragma once

#include <array>

#include <fascia/base/aligned.h>
#include <fascia/base/ids.h>
#include <fascia/math/types.h>

namespace fascia {

// Solids in world space at one moment, in three steps: where they are, how their matter moves, and
// where each point of it is. Functions take the weakest that will do. A solid need not be one
// shape: a blend of many elements stands wherever a sphere does.

// Where solids are: all that is needed to wrap, to draw or to press something out of them.
class DistanceField {
 public:
  virtual ~DistanceField() = default;
  virtual std::size_t solidCount() const = 0;
  virtual Box bounds(SolidId solid) const = 0;
  // Signed distance estimate (m, negative inside), right to the first order at the surface, and
  // outward unit normal at `points`.
  // Reads and writes points.count entries of each array; no alignment required.
  virtual void evaluate(SolidId solid, ConstVectors points, float* distance_m,
                        Vectors normal) const = 0;
  // How fast the estimate changes at most, L ≥ 1: |d(p) − d(q)| ≤ L |p − q|. Then d/L is never more
  // than the way to the surface. Distances have 1; blends and other estimates may have more.
  virtual double lipschitz(SolidId) const { return 1; }
};

// How their matter moves: enough for contact.
class MovingField : public DistanceField {
 public:
  // The frame that the solid's shape is given in: while only the frame changes, it moves rigidly.
  virtual Transform frame(SolidId solid) const = 0;
  // Eight points around the solid in its frame, fixed to its shape: no point of its surface moves
  // much farther than the farthest of them when the shape changes.
  static constexpr std::size_t kOutline = 8;
  using Outline = std::array<Vec3, kOutline>;
  virtual const Outline& outline(SolidId solid) const = 0;
  // Velocity of the solid's own matter at each point (rigid motion and swelling), m/s.
  virtual void velocity(SolidId solid, ConstVectors points, Vectors velocity) const = 0;
};

// Where each point of their matter is: what anchors need. Implemented by PosedFlesh and others; a
// test can hand over one sphere.
class Field : public MovingField {
 public:
  // Material coordinates move with the solid and swell with it: anchors live there.
  virtual Vec3 materialFromWorld(SolidId solid, const Vec3& world) const = 0;
  virtual Vec3 worldFromMaterial(SolidId solid, const Vec3& material) const = 0;
  // The same for a batch: reads and writes materials.count entries of each array.
  virtual void worldFromMaterials(SolidId solid, ConstVectors materials, Vectors world) const {
    for (std::size_t i = 0; i < materials.count; ++i) {
      const Vec3 p = worldFromMaterial(solid, Vec3(materials.x[i], materials.y[i], materials.z[i]));
      world.x[i] = static_cast<float>(p.x());
      world.y[i] = static_cast<float>(p.y());
      world.z[i] = static_cast<float>(p.z());
    }
  }
};

}  // namespace fascia
