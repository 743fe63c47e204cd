#include <fascia/io/file/gzip.h>

#include <algorithm>
#include <memory>

#include <zlib.h>

#include <fascia/base/error.h>
#include <fascia/io/file/file.h>

namespace fascia {
namespace {

// Unpacks all members of a gzip file (RFC 1952 allows several, one after the other).
std::string unpack(std::string& packed, const std::string& path, std::size_t maxBytes) {
  constexpr int kGzipOnly = 15 + 16;  // largest window; zlib's sign for a gzip header
  z_stream stream{};
  if (inflateInit2(&stream, kGzipOnly) != Z_OK)
    throw fileError(path, "cannot be unpacked: out of memory");
  const std::unique_ptr<z_stream, void (*)(z_stream*)> end(&stream,
                                                           [](z_stream* s) { inflateEnd(s); });
  std::string bytes;
  char buffer[1 << 16];
  std::size_t taken = 0;
  while (taken < packed.size()) {
    const std::size_t portion = std::min<std::size_t>(packed.size() - taken, 1u << 20);
    stream.next_in = reinterpret_cast<Bytef*>(packed.data() + taken);
    stream.avail_in = static_cast<uInt>(portion);
    stream.next_out = reinterpret_cast<Bytef*>(buffer);
    stream.avail_out = sizeof buffer;
    const int result = inflate(&stream, Z_NO_FLUSH);
    if (result != Z_OK && result != Z_STREAM_END) throw fileError(path, "is a damaged gzip file");
    taken += portion - stream.avail_in;
    bytes.append(buffer, sizeof buffer - stream.avail_out);
    if (bytes.size() > maxBytes) {
      throw fileError(path, "is larger than " + std::to_string(maxBytes) + " bytes when unpacked");
    }
    if (result == Z_STREAM_END) {
      if (taken == packed.size()) return bytes;
      inflateReset(&stream);
    }
  }
  throw fileError(path, "is a gzip file that is cut short");
}

}  // namespace

std::string readFileUnpacked(const std::string& path, std::size_t maxBytes) {
  std::string bytes = readFile(path, maxBytes);
  const bool packed = bytes.size() >= 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b';
  return packed ? unpack(bytes, path, maxBytes) : bytes;
}

}  // namespace fascia
