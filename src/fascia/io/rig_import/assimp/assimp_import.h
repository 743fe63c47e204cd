#pragma once

#include <string>
#include <string_view>

#include <fascia/io/rig_model/rig_import_options.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// Whether files with an ending (".fbx", small letters) are read through the assimp library.
bool isAssimpEnding(std::string_view ending);

// A rigged character in such a file. The library runs in a process of its own with bounded memory
// and time, and the model comes back through a pipe: a file that breaks the library breaks nothing
// else. Throws Error.
RiggedModel readWithAssimp(const std::string& path, const RigImportOptions& options = {});

}  // namespace fascia
