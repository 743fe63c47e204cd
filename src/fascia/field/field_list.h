#pragma once

#include <vector>

#include <fascia/base/assert.h>
#include <fascia/field/field.h>

namespace fascia {

// Several fields as one: the solids of the first, then those of the second, numbered on. The fields
// must outlive it, and may change, but for how many solids they have.
class FieldList final : public Field {
  // Calls visit(field, id) with the field that the solid is in, and its number there.
  template <class Visit>
  decltype(auto) with(SolidId solid, const Visit& visit) const {
    FASCIA_ASSERT(solid.index() < solidCount(), "the solid is of one of the fields");
    std::size_t i = 0;
    while (solid.index() >= ends_[i]) ++i;
    const std::size_t first = i == 0 ? 0 : ends_[i - 1];
    return visit(*fields_[i], SolidId(static_cast<std::int64_t>(solid.index() - first)));
  }

 public:
  void clear() { fields_.clear(), ends_.clear(); }
  void add(const Field& field) {
    ends_.push_back(solidCount() + field.solidCount());
    fields_.push_back(&field);
  }

  std::size_t solidCount() const override { return ends_.empty() ? 0 : ends_.back(); }
  Box bounds(SolidId solid) const override {
    return with(solid, [](const Field& f, SolidId s) { return f.bounds(s); });
  }
  void evaluate(SolidId solid, ConstVectors points, float* distance_m,
                Vectors normal) const override {
    with(solid, [&](const Field& f, SolidId s) { f.evaluate(s, points, distance_m, normal); });
  }
  double lipschitz(SolidId solid) const override {
    return with(solid, [](const Field& f, SolidId s) { return f.lipschitz(s); });
  }
  Transform frame(SolidId solid) const override {
    return with(solid, [](const Field& f, SolidId s) { return f.frame(s); });
  }
  const Outline& outline(SolidId solid) const override {
    return with(solid, [](const Field& f, SolidId s) -> const Outline& { return f.outline(s); });
  }
  void velocity(SolidId solid, ConstVectors points, Vectors velocity) const override {
    with(solid, [&](const Field& f, SolidId s) { f.velocity(s, points, velocity); });
  }
  Vec3 materialFromWorld(SolidId solid, const Vec3& world) const override {
    return with(solid, [&](const Field& f, SolidId s) { return f.materialFromWorld(s, world); });
  }
  Vec3 worldFromMaterial(SolidId solid, const Vec3& material) const override {
    return with(solid, [&](const Field& f, SolidId s) { return f.worldFromMaterial(s, material); });
  }
  void worldFromMaterials(SolidId solid, ConstVectors materials, Vectors world) const override {
    with(solid, [&](const Field& f, SolidId s) { f.worldFromMaterials(s, materials, world); });
  }

 private:
  std::vector<const Field*> fields_;
  std::vector<std::size_t> ends_;  // of each field's solids
};

}  // namespace fascia
