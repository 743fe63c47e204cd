#pragma once

#include <string>

#include <fascia/rig/rigged_model.h>

struct aiScene;

namespace fascia {

// Part of readWithAssimp(): the library's scene as a model. Throws Error where it has no rig.
// Without what finishModel() does.
RiggedModel rigFromAssimp(const aiScene& scene, const std::string& path, double scale);

}  // namespace fascia
