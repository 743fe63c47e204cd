#pragma once

#include <string>
#include <vector>

#include <fascia/io/gltf/gltf_document.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// The joints and motions of a glTF that is wanted for how it moves: of its rig, or, where no mesh
// has a skin, of the nodes that its animations and its human bones (.vrma) name. What surface there
// is has no meaning. Throws Error.
RiggedModel figureFromGltf(const GltfDocument& document);

// Per joint, what the document says that it is (see guessMeanings); empty if it says nothing.
std::vector<std::string> saidOf(const GltfDocument& document, const RiggedModel& model);

}  // namespace fascia
