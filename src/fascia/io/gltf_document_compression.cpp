#include <fascia/io/gltf_document.h>

namespace fascia {
void GltfDocument::unpackCompressedViews() {}
void GltfDocument::unpackCompressedMeshes() {}
void GltfDocument::writeGlb(const std::string&) const {}
}  // namespace fascia
