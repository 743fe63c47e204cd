#pragma once

#include <string>
#include <string_view>

#include <fascia/io/gltf/gltf_document.h>

namespace fascia {

// Whether files with an ending (".fbx", small letters) are read through the assimp library.
bool isAssimpEnding(std::string_view ending);

// A rigged character in such a file, converted to glTF. The library runs in a process of its own
// with bounded memory and time: a file that breaks it breaks nothing else. Throws Error.
GltfDocument readWithAssimp(const std::string& path);

}  // namespace fascia
