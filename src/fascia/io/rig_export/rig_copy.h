#pragma once

#include <string>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// Writes a rig as .glb, to be read again: a glTF keeps everything that it holds, of other formats
// what we understand is kept. `scale`: that the model was read with; returns the one that the copy
// is to be read with. Throws Error.
double copyRig(const RiggedModel& model, double scale, const std::string& path);

}  // namespace fascia
