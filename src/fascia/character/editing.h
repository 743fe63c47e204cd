#pragma once

#include <string>

#include <fascia/character/character.h>

namespace fascia {

// Editing a character while it moves:
//
//   CharacterDef def = character.def();
//   def.skin->tissue.stiffness_N_per_m3 = 9000;
//   Character next = character.edited(def);
//   state = carryOver(character, state, next);
//
// Sources of the former character are not those of the edited one: next.source(motion).

// The state of a running character as one of the character that it was edited into. Points of the
// skin keep their places and velocities; strands go on from where the edit puts their inner ends,
// so that the skin follows an edit by its own elasticity and contact. Only if an edit moves flesh
// farther than a twentieth of the skin's size, skin goes along with what it is tied to. Soft solids
// keep their shapes and go along with their frames. A skin of another resolution is resampled; what
// is new starts where the pose puts it. `state` must fit `from`.
CharacterState carryOver(const Character& from, const CharacterState& state, const Character& to);

// Throws Error if a state is not one of this character: other numbers of points or bodies.
void requireFits(const Character& character, const CharacterState& state);

// Renames a joint or a solid of the flesh wherever the definition refers to it. A joint of a rig
// goes on to be found in its file by the name that it has there (RigDef::joint_names). Throws Error
// if there is none of that name, if the new name is empty or taken, or if the rig was not read yet.
void renameJoint(CharacterDef& def, const std::string& from, const std::string& to);
void renameSolid(CharacterDef& def, const std::string& from, const std::string& to);

}  // namespace fascia
