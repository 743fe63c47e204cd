#pragma once

#include <memory>

#include <fascia/character/character_def.h>

namespace fascia {

// The rigged mesh that a character names, found from its folder; null if it names none. Throws
// Error at /rig/file: the name leads out of the folder, nothing is there, or all that is wrong
// inside of it.
std::shared_ptr<const RiggedModel> loadRig(const CharacterDef& def);

}  // namespace fascia
