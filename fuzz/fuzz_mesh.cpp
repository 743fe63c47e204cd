// Any bytes either are a mesh without a rig in a glTF, or throw Error.
#include <fascia/base/error.h>
#include <fascia/io/rig_import/mesh_file.h>

#include "scratch.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fascia::textOf(data, size);
  try {
    static const fascia::Scratch scratch;
    fascia::readMeshFile(scratch.write("fuzz.gltf", bytes));
  } catch (const fascia::Error&) {
  }
  return 0;
}
