#pragma once

#include <string>

#include <fascia/rig/rigged_model.h>

namespace fascia {

struct RigImportOptions {
  double scale = 1;  // of all lengths; 0.01 for a file in centimetres
};

// Reads a rigged character by the ending of its file: .glb and .gltf by ourselves; .fbx, .dae, .obj
// and others through assimp; MakeHuman's base.obj with its rig (see makehuman_import.h). Faults
// that can be mended are, and noted in the model; others throw Error with all that is wrong. Never
// crashes, hangs or allocates without bound on a stranger's file.
RiggedModel readRiggedModel(const std::string& path, const RigImportOptions& options = {});

}  // namespace fascia
