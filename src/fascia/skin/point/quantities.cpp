#include <fascia/skin/point/quantities.h>

namespace fascia {
namespace {

using Q = SkinQuantity;
constexpr QuantityInfo kInfos[kSkinQuantities] = {
    {Q::density, "density", "kg/m²", 0.01, 1000},
    {Q::stretch_u, "stretch_u", "N/m", 1e-3, 1e6},
    {Q::stretch_v, "stretch_v", "N/m", 1e-3, 1e6},
    {Q::shear, "shear", "N/m", 0, 1e6},
    {Q::bending, "bending", "N m", 0, 1e3},
    {Q::drag, "drag", "N s/m³", 0, 1e5},
    {Q::prestretch, "prestretch", "", 0.5, 3},
    {Q::fat, "fat", "m", 0, 1},
    {Q::tissue_stiffness, "tissue_stiffness", "N/m³", 0, 1e8},
    {Q::tissue_damping, "tissue_damping", "N s/m³", 0, 1e6},
    {Q::tissue_rest_length, "tissue_rest_length", "m", 0, 1},
    {Q::jiggle, "jiggle", "", 0, 1},
    {Q::muscle, "muscle", "", 0, 1},
    {Q::volume, "volume", "", 0, 1},
    {Q::tightness, "tightness", "", 0, 1},
};

}  // namespace

std::span<const QuantityInfo> quantityInfos() {
  return kInfos;
}

const QuantityInfo& info(SkinQuantity quantity) {
  return kInfos[static_cast<std::size_t>(quantity)];
}

const QuantityInfo* findQuantity(std::string_view name) {
  for (const QuantityInfo& i : kInfos)
    if (i.name == name) return &i;
  return nullptr;
}

double uniformValue(const SkinDef& def, SkinQuantity quantity) {
  switch (quantity) {
    case Q::density:
      return def.material.density_kg_per_m2;
    case Q::stretch_u:
      return def.material.stretch_u_N_per_m;
    case Q::stretch_v:
      return def.material.stretch_v_N_per_m;
    case Q::shear:
      return def.material.shear_N_per_m;
    case Q::bending:
      return def.material.bending_Nm;
    case Q::drag:
      return def.material.drag_Ns_per_m3;
    case Q::prestretch:
      return def.material.prestretch;
    case Q::fat:
      return def.fat.thickness_m;
    case Q::tissue_stiffness:
      return def.tissue.stiffness_N_per_m3;
    case Q::tissue_damping:
      return def.tissue.damping_Ns_per_m3;
    case Q::tissue_rest_length:
      return def.tissue.rest_length_m.value_or(0);
    case Q::jiggle:
      return def.pose.jiggle;
    case Q::muscle:
      return def.pose.muscle;
    case Q::volume:
      return def.pose.volume;
    case Q::tightness:
      return def.pose.tightness;
  }
  return 0;
}

SharedList<float>& pointValues(SkinPointsDef& p, SkinQuantity quantity) {
  switch (quantity) {
    case Q::density:
      return p.density;
    case Q::stretch_u:
      return p.stretch_u;
    case Q::stretch_v:
      return p.stretch_v;
    case Q::shear:
      return p.shear;
    case Q::bending:
      return p.bending;
    case Q::drag:
      return p.drag;
    case Q::prestretch:
      return p.prestretch;
    case Q::fat:
      return p.fat;
    case Q::tissue_stiffness:
      return p.tissue_stiffness;
    case Q::tissue_damping:
      return p.tissue_damping;
    case Q::tissue_rest_length:
      return p.tissue_rest_length;
    case Q::jiggle:
      return p.jiggle;
    case Q::muscle:
      return p.muscle;
    case Q::volume:
      return p.volume;
    case Q::tightness:
      break;
  }
  return p.tightness;
}

const SharedList<float>& pointValues(const SkinPointsDef& points, SkinQuantity quantity) {
  return pointValues(const_cast<SkinPointsDef&>(points), quantity);
}

}  // namespace fascia
