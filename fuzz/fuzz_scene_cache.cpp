// Any bytes either are a recorded scene or throw Error.
#include <fascia/base/error.h>
#include <fascia/io/cache/scene_cache.h>

#include "scratch.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fascia::textOf(data, size);
  try {
    fascia::parseSceneCache(bytes, "fuzz");
  } catch (const fascia::Error&) {
  }
  return 0;
}
