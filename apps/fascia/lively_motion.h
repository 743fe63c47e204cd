#pragma once

#include <string>

#include <fascia/character/character.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// The motion that moves its joints most, and so is worth seeing: files often begin with a rest pose
// or somebody who stands. Empty if there is none.
std::string livelyMotion(const RiggedModel& rig);
std::string livelyMotion(const Character& character);

// " --motion NAME" for a command that is shown; nothing if there is none.
std::string motionOption(const std::string& motion);

}  // namespace fascia
