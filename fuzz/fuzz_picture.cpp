// Any bytes either are a picture, of the size that its head tells, or throw Error.
#include <fascia/base/error.h>
#include <fascia/io/picture/image.h>

#include "scratch.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fascia::textOf(data, size);
  try {
    const fascia::Image image = fascia::decodeImage(bytes, "fuzz");
    fascia::checkPicture(bytes, "fuzz");
    const std::size_t width = static_cast<std::size_t>(image.width);
    if (image.rgba.size() != 4 * width * static_cast<std::size_t>(image.height)) std::abort();
  } catch (const fascia::Error&) {
  }
  return 0;
}
