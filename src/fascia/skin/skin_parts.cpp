#include <fascia/skin/skin_parts.h>

#include <algorithm>

#include <fascia/base/suggest.h>

namespace fascia {

void SkinReport::error(const std::string& where, std::string message, std::string hint) const {
  diagnostics_.error(pointer_ + where, std::move(message), std::move(hint));
}

void SkinReport::checkRange(const std::string& where, double value, double low, double high) const {
  if (value >= low && value <= high) return;  // false for NaN
  error(where, "found " + std::to_string(value) + ", expected a number from " +
                   std::to_string(low) + " to " + std::to_string(high));
}

void SkinReport::checkValues(const SkinDef& def) const {
  static constexpr std::pair<SkinQuantity, const char*> kWhere[] = {
      {SkinQuantity::density, "/material/density_kg_per_m2"},
      {SkinQuantity::stretch_u, "/material/stretch_u_N_per_m"},
      {SkinQuantity::stretch_v, "/material/stretch_v_N_per_m"},
      {SkinQuantity::shear, "/material/shear_N_per_m"},
      {SkinQuantity::bending, "/material/bending_Nm"},
      {SkinQuantity::drag, "/material/drag_Ns_per_m3"},
      {SkinQuantity::prestretch, "/material/prestretch"},
      {SkinQuantity::fat, "/fat/thickness_m"},
      {SkinQuantity::tissue_stiffness, "/tissue/stiffness_N_per_m3"},
      {SkinQuantity::tissue_damping, "/tissue/damping_Ns_per_m3"},
      {SkinQuantity::tissue_rest_length, "/tissue/rest_length_m"},
      {SkinQuantity::jiggle, "/pose/jiggle"},
      {SkinQuantity::muscle, "/pose/muscle"},
      {SkinQuantity::volume, "/pose/volume"},
      {SkinQuantity::tightness, "/pose/tightness"}};
  for (const auto& [quantity, where] : kWhere)
    checkRange(where, uniformValue(def, quantity), info(quantity).min, info(quantity).max);
  checkRange("/material/max_stretch", def.material.max_stretch, 1.01, 4);
  checkRange("/material/friction_per_s", def.material.friction_per_s, 0, 1e4);
  checkRange("/material/restitution", def.material.restitution, 0, 1);
  checkRange("/cling", def.cling, 0, 1);
  for (std::size_t i = 0; i < def.brushes.size(); ++i)
    checkRange("/brushes/" + std::to_string(i) + "/radius_m", def.brushes[i].radius_m, 1e-6, 1e6);
  checkRange("/tissue/carry", def.tissue.carry, 0, 1);
  checkRange("/fat/compressible", def.fat.compressible, 0, 0.95);
  checkRange("/fat/bulk_Pa", def.fat.bulk_Pa, 0, 1e5);
  checkRange("/contact/gap_m", def.contact.gap_m, 1e-9, 1);
}

bool SkinReport::checkPointLists(const SkinPointsDef& p, std::size_t count,
                                 const std::string& expected) const {
  bool ok = true;
  const auto check = [&](std::size_t size, std::string_view name) {
    if (size == 0 || size == count) return;
    error("/points/" + std::string(name), "found " + std::to_string(size) + " values, expected " +
                                              std::to_string(count) + " (" + expected +
                                              ") or none");
    ok = false;
  };
  for (const QuantityInfo& i : quantityInfos()) {
    const std::vector<float>& values = pointValues(p, i.quantity);
    check(values.size(), i.name);
    for (const float v : values) {
      if (v >= static_cast<float>(i.min) && v <= static_cast<float>(i.max)) continue;
      checkRange("/points/" + std::string(i.name), v, i.min, i.max);
      ok = false;
      break;
    }
  }
  return ok;
}

JointId SkinReport::findJoint(const std::string& where, const std::string& name) const {
  const JointId id = base_.skeleton.find(name);
  if (!id.valid()) {
    std::vector<std::string_view> names;
    for (std::size_t i = 0; i < base_.skeleton.jointCount(); ++i)
      names.push_back(base_.skeleton.joint(JointId(static_cast<std::int64_t>(i))).name);
    error(where, "found no joint named '" + name + "'", didYouMean(name, names));
  }
  return id;
}

SolidId SkinReport::findSolid(const std::string& where, const std::string& name) const {
  const SolidId id = base_.flesh.find(name);
  if (!id.valid()) {
    std::vector<std::string_view> names;
    for (std::size_t s = 0; s < base_.flesh.solidCount(); ++s)
      names.push_back(base_.flesh.def(SolidId(static_cast<std::int64_t>(s))).name);
    error(where, "found no solid named '" + name + "'", didYouMean(name, names));
  }
  return id;
}

NearestFlesh nearestFlesh(const Field& field, const Vec3& p, std::span<const SolidId> solids) {
  const float x = static_cast<float>(p.x()), y = static_cast<float>(p.y()),
              z = static_cast<float>(p.z());
  NearestFlesh best;
  for (const SolidId solid : solids) {
    float d, nx, ny, nz;
    field.evaluate(solid, {&x, &y, &z, 1}, &d, {&nx, &ny, &nz, 1});
    if (d < best.distance) best = {d, solid, Vec3(nx, ny, nz)};
  }
  return best;
}

NearestFlesh nearestFlesh(const Field& field, const Vec3& p) {
  std::vector<SolidId> all;
  for (std::size_t s = 0; s < field.solidCount(); ++s)
    all.emplace_back(static_cast<std::int64_t>(s));
  return nearestFlesh(field, p, all);
}

PointModel makePointModel(const PointModelInput& in) {
  const SkinQuantities& q = in.quantities;
  const auto least = static_cast<float>(in.leastArea_m2);
  PointModel p;
  for (FloatArray* a : {&p.mass, &p.drag, &p.fat, &p.tissueStiffness, &p.tissueDamping,
                        &p.tissueRestLength, &p.free})
    a->assign(in.area.size(), 0.f);
  p.stiffnessBound = in.stiffness;
  for (const std::size_t k : in.points) {
    const float area = std::max(in.area[k], least);
    p.mass[k] = q[SkinQuantity::density][k] * area;
    p.drag[k] = q[SkinQuantity::drag][k] * area;
    p.fat[k] = q[SkinQuantity::fat][k];
    p.free[k] = 1;
  }
  for (const std::size_t k : in.fixedPoints) p.free[k] = 0;
  for (const std::size_t k : in.tied) {
    const float area = std::max(in.area[k], least);
    p.tissueStiffness[k] = q[SkinQuantity::tissue_stiffness][k] * area;
    p.tissueDamping[k] = q[SkinQuantity::tissue_damping][k] * area;
    p.tissueRestLength[k] = q[SkinQuantity::tissue_rest_length][k];
    p.stiffnessBound[k] += p.tissueStiffness[k];
  }
  return p;
}

}  // namespace fascia
