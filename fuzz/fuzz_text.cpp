// Any bytes are shown as text that moves no cursor, and stays as it is when shown again.
#include <fascia/base/error.h>
#include <fascia/base/printable.h>

#include "scratch.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fascia::textOf(data, size);
  try {
    const std::string shown = fascia::printable(bytes);
    for (const char c : shown)
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) std::abort();
    if (fascia::printable(shown) != shown) std::abort();
  } catch (const fascia::Error&) {
  }
  return 0;
}
