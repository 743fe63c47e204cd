#pragma once

#include <string>

#include <fascia/io/rig_model/rig_import_options.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// Reads a rigged character by the ending of its file: .glb and .gltf by ourselves; .fbx, .dae, .obj
// and others through assimp; MakeHuman's base.obj with its rig (see makehuman_import.h). Faults
// that can be mended are, and noted in the model; others throw Error with all that is wrong. Never
// crashes, hangs or allocates without bound on a stranger's file.
RiggedModel readRiggedModel(const std::string& path, const RigImportOptions& options = {});

// Whether a file is a glTF, by its ending: what is written for such a rig keeps all that the file
// holds, also what we do not understand.
bool isGltfFile(const std::string& path);

}  // namespace fascia
