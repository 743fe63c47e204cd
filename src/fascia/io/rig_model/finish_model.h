#pragma once

#include <string>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// What readers of formats other than glTF do last: the model is called by its file, its joints and
// parts are numbered as the glTF that is made out of it numbers them (see gltfOf), and what a
// person would notice is noted. `scale` is the one it was read with.
void finishModel(const std::string& path, double scale, RiggedModel& model);

}  // namespace fascia
