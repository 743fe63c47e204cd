// Any bytes either are a motion capture, from which a figure can be posed, or throw Error.
#include <cstdint>
#include <string_view>

#include <fascia/base/error.h>
#include <fascia/io/motion/bvh.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const fascia::BvhMotion motion =
        fascia::parseBvh({reinterpret_cast<const char*>(data), size}, "fuzz");
    fascia::figureOf(motion, fascia::guessBvhUnit_m(motion));
  } catch (const fascia::Error&) {
  }
  return 0;
}
