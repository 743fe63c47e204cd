#pragma once

#include <memory>

#include <fascia/character/character_def.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// The character that 'fascia flesh' makes of a rigged mesh by default, without writing it.
CharacterDef fleshedCharacter(const std::shared_ptr<const RiggedModel>& model);

}  // namespace fascia
