// Any bytes either are a cache file or throw Error.
#include <cstdint>
#include <string_view>

#include <fascia/io/cache/cache.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    fascia::parseCache({reinterpret_cast<const char*>(data), size}, "fuzz");
  } catch (const fascia::Error&) {
  }
  return 0;
}
