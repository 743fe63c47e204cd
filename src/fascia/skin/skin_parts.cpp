#include <fascia/skin/skin_parts.h>

#include <algorithm>

#include <fascia/base/assert.h>
#include <fascia/base/parallel.h>
#include <fascia/base/suggest.h>
#include <fascia/math/points.h>

namespace fascia {

void SkinReport::error(const std::string& where, std::string message, std::string hint) const {
  diagnostics_.error(pointer_ + where, std::move(message), std::move(hint));
}

bool SkinReport::checkSide(const std::string& where, int side) const {
  checkWhole(kGridSide, side, pointer_ + where, diagnostics_);
  return kGridSide.range.contains(static_cast<double>(side));
}

bool SkinReport::checkValues(const SkinDef& def) const {
  const std::size_t before = diagnostics_.errors().size();
  const auto check = [this](const auto& part, const std::string& where) {
    validateTunables(part, pointer_ + where, diagnostics_);
  };
  check(def.grid, "");
  check(def.material, "/material");
  check(def.fat, "/fat");
  check(def.tissue, "/tissue");
  check(def.mesh.pose, "/pose");
  check(def.contact, "/contact");
  check(def.grid.bottom, "/bottom");
  check(def.grid.top, "/top");
  if (def.surface) check(*def.surface, "/surface");
  for (std::size_t i = 0; i < def.brushes.size(); ++i)
    check(def.brushes[i], entryOf("/brushes", i));
  for (std::size_t i = 0; i < def.grid.anchors.size(); ++i)
    check(def.grid.anchors[i], entryOf("/anchors", i));
  for (std::size_t i = 0; i < def.regions.size(); ++i) checkRegion(def.regions[i], i);
  return diagnostics_.errors().size() == before;
}

void SkinReport::checkRegion(const SkinRegionDef& region, std::size_t index) const {
  const std::string at = pointer_ + entryOf("/regions", index);
  validateTunables(region, at, diagnostics_);
  checkNumber(kRegionU, region.u_min, at + "/u/0", diagnostics_);
  checkNumber(kRegionU, region.u_max, at + "/u/1", diagnostics_);
  checkNumber(kRegionV, region.v_min, at + "/v/0", diagnostics_);
  checkNumber(kRegionV, region.v_max, at + "/v/1", diagnostics_);
  for (std::size_t i = 0; i < region.edits.size(); ++i)
    validateTunables(region.edits[i], entryOf(at + "/edits", i), diagnostics_);
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
    check(values.size(), i.listKey);
    for (const float v : values) {
      if (i.uniform.range.contains(v)) continue;
      error("/points/" + std::string(i.listKey),
            "found " + shortestText(v) + ", expected " + i.uniform.range.text());
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

NearestFlesh nearestFlesh(const DistanceField& field, const Vec3& p,
                          std::span<const SolidId> solids) {
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

NearestFlesh nearestFlesh(const DistanceField& field, const Vec3& p) {
  std::vector<SolidId> all;
  for (std::size_t s = 0; s < field.solidCount(); ++s)
    all.emplace_back(static_cast<std::int64_t>(s));
  return nearestFlesh(field, p, all);
}

PointModel makePointModel(const PointModelInput& in) {
  const SkinQuantities& q = in.quantities;
  const auto least = static_cast<float>(in.leastArea_m2);
  FASCIA_ASSERT(in.stiffness.size() == in.area.size(), "a stiffness for each point");
  FASCIA_ASSERT(areBelow(in.points, in.area.size()) && areBelow(in.tied, in.area.size()),
                "points of the skin");
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

void setNaturalLengths(const SkinDef& def, const PosedFlesh& flesh,
                       const std::vector<TissueAnchors::Anchor>& anchors, const VectorArray& rest,
                       FloatArray& restLength_m) {
  if (def.tissue.rest_length_m || (def.points && !def.points->tissue_rest_length.empty())) return;
  parallelFor(anchors.size(), [&](std::size_t n) {
    const TissueAnchors::Anchor& a = anchors[n];
    const Vec3 inner = flesh.worldFromMaterial(a.solid, a.material);
    restLength_m[a.point] = static_cast<float>((pointAt(rest, a.point) - inner).norm());
  });
}

TriangleMaterial triangleMaterial(const SkinQuantities& q, double maxStretch) {
  TriangleMaterial material;
  material.stretch_u = q[SkinQuantity::stretch_v];
  material.stretch_v = q[SkinQuantity::stretch_u];
  material.shear = q[SkinQuantity::shear];
  material.bending = q[SkinQuantity::bending];
  material.prestretch = q[SkinQuantity::prestretch];
  material.max_stretch = static_cast<float>(maxStretch);
  return material;
}

}  // namespace fascia
