#pragma once

#include <string>
#include <string_view>

#include <fascia/character/character.h>

namespace fascia {

// A running character in a file, *.fstate: whoever reads it, in whatever process, goes on bit for
// bit as the run that it was saved from. The character itself is not in it; the same one is needed,
// or one edited from it that has the same joints, solids and points.

// Throws Error if the state is not one of this character.
std::string saveState(const Character& character, const CharacterState& state);
// Throws Error, all faults at once, if the bytes are damaged or of another character.
CharacterState loadState(const Character& character, std::string_view bytes,
                         const std::string& file = {});

// Whole or not at all. Both throw Error as those above, and if the file cannot be used.
void writeStateFile(const Character& character, const CharacterState& state,
                    const std::string& path);
CharacterState readStateFile(const Character& character, const std::string& path);

}  // namespace fascia
