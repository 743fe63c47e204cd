#pragma once

#include <vector>

#include <fascia/deformable/body/body_field.h>
#include <fascia/flesh/flesh.h>

namespace fascia {

// The flesh that the skin feels: solids on joints, some of them replaced by the deformable bodies
// that they are made of. Numbered like the flesh; material coordinates are points of the solid at
// rest, in its own frame, whichever of the two it is. A plain value.
class LayeredFlesh final : public Field {
 public:
  // The bodies' solids, and which of them stands for each solid of the flesh (invalid: none).
  void setSoft(BodyField soft, std::vector<SolidId> softOf);

  PosedFlesh& rigid() { return rigid_; }
  const PosedFlesh& rigid() const { return rigid_; }
  BodyField& soft() { return soft_; }
  const BodyField& soft() const { return soft_; }
  // Of the bodies' solids; invalid if this solid is no body.
  SolidId softOf(SolidId solid) const {
    return solid.index() < softOf_.size() ? softOf_[solid.index()] : SolidId();
  }

  std::size_t solidCount() const override { return rigid_.solidCount(); }
  Box bounds(SolidId solid) const override;
  void evaluate(SolidId solid, ConstVectors points, float* distance_m,
                Vectors normal) const override;
  Transform frame(SolidId solid) const override;
  const Outline& outline(SolidId solid) const override;
  void velocity(SolidId solid, ConstVectors points, Vectors velocity) const override;
  Vec3 materialFromWorld(SolidId solid, const Vec3& world) const override;
  Vec3 worldFromMaterial(SolidId solid, const Vec3& material) const override;
  void worldFromMaterials(SolidId solid, ConstVectors materials, Vectors world) const override;

 private:
  // Calls visit(field, id) with the field that the solid is in now, and its number there.
  template <class Visit>
  decltype(auto) with(SolidId solid, Visit&& visit) const {
    const SolidId body = softOf(solid);
    return body.valid() ? visit(static_cast<const Field&>(soft_), body)
                        : visit(static_cast<const Field&>(rigid_), solid);
  }

  PosedFlesh rigid_;
  BodyField soft_;
  std::vector<SolidId> softOf_;
};

}  // namespace fascia
