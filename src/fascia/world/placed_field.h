#pragma once

#include <fascia/field/field.h>

namespace fascia {

// A field that stands somewhere else: what a character's flesh is to the scene it is placed in.
// The field must outlive it, and may change.
class PlacedField final : public Field {
 public:
  PlacedField(const Field& field, const Transform& place)
      : field_(&field), place_(place), back_(place.inverse()) {}

  std::size_t solidCount() const override { return field_->solidCount(); }
  Box bounds(SolidId solid) const override;
  void evaluate(SolidId solid, ConstVectors points, float* distance_m,
                Vectors normal) const override;
  double lipschitz(SolidId solid) const override { return field_->lipschitz(solid); }
  Transform frame(SolidId solid) const override { return place_ * field_->frame(solid); }
  const Outline& outline(SolidId solid) const override { return field_->outline(solid); }
  void velocity(SolidId solid, ConstVectors points, Vectors velocity) const override;
  Vec3 materialFromWorld(SolidId solid, const Vec3& world) const override {
    return field_->materialFromWorld(solid, back_.point(world));
  }
  Vec3 worldFromMaterial(SolidId solid, const Vec3& material) const override {
    return place_.point(field_->worldFromMaterial(solid, material));
  }

 private:
  const Field* field_;
  Transform place_, back_;
};

}  // namespace fascia
