#pragma once

#include <vector>

#include <fascia/io/gltf/gltf_place.h>

namespace fascia {

// Everything that the core of glTF and the extensions known to us refer to by number.
std::vector<Json*> accessorReferences(Json& root);
std::vector<Json*> viewReferences(Json& root);

// Throws Error for a reference to something that is not there.
void checkGltfReferences(const GltfPlace& root);

// Extensions that we do not know may refer to any accessor: then no number may change.
bool hasUnknownReferences(const GltfPlace& root);

}  // namespace fascia
