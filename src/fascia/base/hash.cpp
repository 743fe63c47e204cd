#include <fascia/base/hash.h>

#include <cstring>

namespace fascia {

void StateHash::add(const void* data, std::size_t bytes) {
  const auto* p = static_cast<const unsigned char*>(data);
  // Eight bytes a round: states are arrays of floats, and bytewise FNV would cost more than a
  // frame.
  for (; bytes >= 8; bytes -= 8, p += 8) {
    std::uint64_t word;
    std::memcpy(&word, p, 8);
    hash_ = (hash_ ^ word) * 0x100000001b3ull;
    hash_ ^= hash_ >> 29;
  }
  for (; bytes > 0; --bytes, ++p) hash_ = (hash_ ^ *p) * 0x100000001b3ull;
}

std::string StateHash::hex() const {
  static const char digits[] = "0123456789abcdef";
  std::string text(16, '0');
  for (int i = 0; i < 16; ++i) text[15 - i] = digits[(hash_ >> (4 * i)) & 15];
  return text;
}

}  // namespace fascia
