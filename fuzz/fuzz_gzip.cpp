// Any bytes either are read, unpacked if they are a gzip file, or throw Error.
#include <fascia/base/error.h>
#include <fascia/io/file/gzip.h>

#include "scratch.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fascia::textOf(data, size);
  try {
    static const fascia::Scratch scratch;
    fascia::readFileUnpacked(scratch.write("fuzz.gz", bytes), std::size_t{1} << 24);
  } catch (const fascia::Error&) {
  }
  return 0;
}
