// Any three texts either are a mesh, a rig and weights of MakeHuman, or throw Error.
#include <fascia/base/error.h>
#include <fascia/io/rig_import/makehuman/makehuman_import.h>

#include "scratch.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fascia::textOf(data, size);
  try {
    static const fascia::Scratch scratch;
    std::string_view left = bytes;
    scratch.write("base.obj", fascia::nextPart(left));
    const std::string rig = scratch.write("fuzz.mhskel", fascia::nextPart(left));
    scratch.write("fuzz_weights.mhw", left);
    fascia::readMakeHuman(rig);
  } catch (const fascia::Error&) {
  }
  return 0;
}
