#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/field/field.h>
#include <fascia/flesh/flesh.h>
#include <fascia/math/types.h>

namespace fascia {

// An imported skin on flesh that is a deformable body (`"soft"`): points on and near a soft solid
// go where its matter goes, against where the solid's joint alone would take them. The share of a
// point falls off smoothly with its distance from the solid at rest.
class SoftRide {
 public:
  SoftRide() = default;
  // `rest`: the skin's points in the pose of `field` and `joints`.
  SoftRide(const Flesh& flesh, const Field& field, std::span<const Transform> joints,
           const VectorArray& rest, std::size_t count);

  bool empty() const { return solids_.empty(); }
  // `world` is scratch.
  void move(const Field& field, std::span<const Transform> joints, VectorArray& world,
            VectorArray& skin) const;

 private:
  struct Solid {
    SolidId solid;
    std::size_t joint;
    std::vector<std::uint32_t> point;
    std::vector<float> share;
    VectorArray material;         // of the points, in the solid
    std::vector<Vec3> inJoint_m;  // where they were at rest
  };
  std::vector<Solid> solids_;
};

}  // namespace fascia
