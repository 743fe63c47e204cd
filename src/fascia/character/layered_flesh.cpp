#include <fascia/character/layered_flesh.h>

#include <utility>

namespace fascia {

void LayeredFlesh::setSoft(BodyField soft, std::vector<SolidId> softOf) {
  soft_ = std::move(soft), softOf_ = std::move(softOf);
}

Box LayeredFlesh::bounds(SolidId solid) const {
  return with(solid, [](const Field& f, SolidId id) { return f.bounds(id); });
}

void LayeredFlesh::evaluate(SolidId solid, ConstVectors points, float* distance_m,
                            Vectors normal) const {
  with(solid, [&](const Field& f, SolidId id) { f.evaluate(id, points, distance_m, normal); });
}

Transform LayeredFlesh::frame(SolidId solid) const {
  return with(solid, [](const Field& f, SolidId id) { return f.frame(id); });
}

const Field::Outline& LayeredFlesh::outline(SolidId solid) const {
  return with(solid, [](const Field& f, SolidId id) -> const Outline& { return f.outline(id); });
}

void LayeredFlesh::velocity(SolidId solid, ConstVectors points, Vectors velocity) const {
  with(solid, [&](const Field& f, SolidId id) { f.velocity(id, points, velocity); });
}

Vec3 LayeredFlesh::materialFromWorld(SolidId solid, const Vec3& world) const {
  return with(solid, [&](const Field& f, SolidId id) { return f.materialFromWorld(id, world); });
}

Vec3 LayeredFlesh::worldFromMaterial(SolidId solid, const Vec3& material) const {
  return with(solid, [&](const Field& f, SolidId id) { return f.worldFromMaterial(id, material); });
}

void LayeredFlesh::worldFromMaterials(SolidId solid, ConstVectors materials, Vectors world) const {
  with(solid, [&](const Field& f, SolidId id) { f.worldFromMaterials(id, materials, world); });
}

}  // namespace fascia
