#pragma once

#include <fascia/io/documents/plain_codecs.h>
#include <fascia/material/body_def.h>

namespace fascia {

// "affine", "quadratic", {"polynomial": 3} or {"lattice": [3, 2, 2]}; in two dimensions a lattice's
// third number may be left out.
CodecPtr<BodyBasisDef> bodyBasisCodec();

// The fields of a material, flat in the object of whatever is made of it.
template <class T>
void addMaterialFields(ObjectCodec<T>& codec) {
  const auto of = [](auto member) -> double T::* { return member; };
  codec
      .field("density_kg_per_m3", of(&BodyMaterialDef::density_kg_per_m3), numbers(positive(1e6)),
             "Water has 1000; in two dimensions kg per m2")
      .field("rigidity_Pa", of(&BodyMaterial::rigidity_Pa), numbers({0, 1e12}),
             "Against changes of shape; 1e3 jelly, 1e9 nearly rigid")
      .field("volume_Pa", of(&BodyMaterial::volume_Pa), numbers({0, 1e12}),
             "Against changes of volume")
      .field("relaxation_s", of(&BodyMaterial::relaxation_s), numbers({0, 1e3}),
             "Damps swings: the time in which the material yields to a force")
      .field("power_damping_s_per_J", of(&BodyMaterial::power_damping_s_per_J), numbers({0, 1e6}),
             "Damps large swings only")
      .field("drag_per_s", of(&BodyMaterial::drag_per_s), numbers({0, 1e6}),
             "Against all motion, in proportion to the mass");
}

}  // namespace fascia
