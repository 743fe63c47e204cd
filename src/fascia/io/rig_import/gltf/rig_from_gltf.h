#pragma once

#include <fascia/io/gltf/gltf_document.h>
#include <fascia/io/rig_model/rig_import_options.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// A rigged character out of a glTF that was read; see readRiggedModel.
RiggedModel rigFromGltf(const GltfDocument& document, const RigImportOptions& options = {});

}  // namespace fascia
