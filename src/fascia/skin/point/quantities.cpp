#include <fascia/skin/point/quantities.h>

namespace fascia {
namespace {

using Q = SkinQuantity;
using Material = SkinMaterialDef;
using Tissue = SkinTissueDef;
using Pose = SkinPoseDef;
constexpr QuantityInfo kInfos[kSkinQuantities] = {
    {Q::density, "density", "density_kg_per_m2", tunableOf(&Material::density_kg_per_m2)},
    {Q::stretch_u, "stretch_u", "stretch_u_N_per_m", tunableOf(&Material::stretch_u_N_per_m)},
    {Q::stretch_v, "stretch_v", "stretch_v_N_per_m", tunableOf(&Material::stretch_v_N_per_m)},
    {Q::shear, "shear", "shear_N_per_m", tunableOf(&Material::shear_N_per_m)},
    {Q::bending, "bending", "bending_Nm", tunableOf(&Material::bending_Nm)},
    {Q::drag, "drag", "drag_Ns_per_m3", tunableOf(&Material::drag_Ns_per_m3)},
    {Q::prestretch, "prestretch", "prestretch", tunableOf(&Material::prestretch)},
    {Q::fat, "fat", "fat_m", tunableOf(&SkinFatDef::thickness_m)},
    {Q::tissue_stiffness, "tissue_stiffness", "tissue_stiffness_N_per_m3",
     tunableOf(&Tissue::stiffness_N_per_m3)},
    {Q::tissue_damping, "tissue_damping", "tissue_damping_Ns_per_m3",
     tunableOf(&Tissue::damping_Ns_per_m3)},
    {Q::tissue_rest_length, "tissue_rest_length", "tissue_rest_length_m",
     tunableOf(&Tissue::rest_length_m)},
    {Q::jiggle, "jiggle", "jiggle", tunableOf(&Pose::jiggle)},
    {Q::muscle, "muscle", "muscle", tunableOf(&Pose::muscle)},
    {Q::volume, "volume", "volume", tunableOf(&Pose::volume)},
    {Q::tightness, "tightness", "tightness", tunableOf(&Pose::tightness)},
};

}  // namespace

std::span<const QuantityInfo> quantityInfos() {
  return kInfos;
}

const QuantityInfo& info(SkinQuantity quantity) {
  return kInfos[static_cast<std::size_t>(quantity)];
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
      return def.mesh.pose.jiggle;
    case Q::muscle:
      return def.mesh.pose.muscle;
    case Q::volume:
      return def.mesh.pose.volume;
    case Q::tightness:
      return def.mesh.pose.tightness;
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
