// Any bytes either are a rigged character or throw Error. Start from a few small .glb files:
// cp some/small.glb build/fuzz/fuzz/corpus/gltf
#include <cstdint>
#include <string_view>

#include <fascia/io/rig_import/gltf/rig_from_gltf.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const fascia::GltfDocument document = fascia::GltfDocument::parse(bytes, "/nowhere/fuzz.glb");
    fascia::rigFromGltf(document);
  } catch (const fascia::Error&) {
  }
  return 0;
}
