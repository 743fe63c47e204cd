#pragma once

#include <memory>

#include <fascia/character/character_def.h>
#include <fascia/fitting/fit_flesh.h>

namespace fascia {

struct FleshedCharacter {
  CharacterDef def;  // named after the model; rig.file is the model's own file
  FleshFit fit;      // what def has of it, and how well it fits
};

// A character of a rigged mesh: flesh fitted into it, and the mesh for a skin, which is a function
// of the joints with these dials. How far muscles swell is the dials' word, not fit.muscle.
FleshedCharacter fleshCharacter(const std::shared_ptr<const RiggedModel>& model,
                                const FitOptions& fit = {}, const SkinPoseDef& dials = {});

}  // namespace fascia
