#pragma once

#include <string>
#include <vector>

#include <fascia/io/gltf/gltf_document.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// A model that did not come from a glTF as one: a node per joint in their order, a skinned mesh per
// part, materials with their pictures, all motions. Reading it back gives the model again.
GltfDocument gltfOf(const RiggedModel& model);
void writeRigGlb(const RiggedModel& model, const std::string& path);

// Any file that readRiggedModel reads, as glTF: as it is, or converted. What the program writes
// later is made out of this, so that joints and parts keep their numbers. Throws Error.
GltfDocument readAsGltf(const std::string& path);

}  // namespace fascia
