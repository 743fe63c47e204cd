// Any bytes either are a pc2 file or throw Error.
#include <cstdint>
#include <string_view>

#include <fascia/io/cache/pc2.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    fascia::parsePc2({reinterpret_cast<const char*>(data), size}, "fuzz");
  } catch (const fascia::Error&) {
  }
  return 0;
}
