// Any text either is a joint map, plain or as JSON, which is printed and read again, or throws
// Error.
#include <fascia/base/error.h>
#include <fascia/io/motion/joint_map_file.h>

#include "scratch.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fascia::textOf(data, size);
  try {
    fascia::printJointMap(fascia::jointMapOf(bytes, "fuzz"));
  } catch (const fascia::Error&) {
  }
  return 0;
}
