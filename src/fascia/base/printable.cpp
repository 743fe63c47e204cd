#include <fascia/base/printable.h>

#include <cstdint>
#include <cstdio>

namespace fascia {
namespace {

struct CodePoint {
  std::uint32_t code = 0;
  std::size_t bytes = 1;
  bool valid = false;
};

// The character that UTF-8 text begins with (RFC 3629: neither overlong nor half of a pair).
CodePoint firstOf(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return {lead, 1, true};
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {};
  std::uint32_t code = lead & (0x7fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3fu);
  }
  constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  if (code < kLeast[bytes] || code > 0x10ffff || (code >= 0xd800 && code <= 0xdfff)) return {};
  return {code, bytes, true};
}

bool movesText(std::uint32_t code) {
  const bool controls = code < 0x20 || (code >= 0x7f && code <= 0x9f);
  const bool separates = code == 0x2028 || code == 0x2029;
  const bool turns = (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
  return controls || separates || turns;
}

std::string escape(const char* format, std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string shortEscape(std::uint32_t code) {
  if (code == '\n') return "\\n";
  if (code == '\r') return "\\r";
  if (code == '\t') return "\\t";
  return escape(code < 0x100 ? "\\x%02x" : "\\u%04x", code);
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const CodePoint c = firstOf(text);
    if (!c.valid)
      out += escape("\\x%02x", static_cast<unsigned char>(text[0]));
    else if (movesText(c.code))
      out += shortEscape(c.code);
    else
      out += text.substr(0, c.bytes);
    text.remove_prefix(c.bytes);
  }
  return out;
}

std::string printableJson(std::string_view document) {
  std::string out;
  out.reserve(document.size());
  while (!document.empty()) {
    const CodePoint c = firstOf(document);
    const bool layout = c.code == '\n';
    out += c.valid && !layout && movesText(c.code) ? escape("\\u%04x", c.code)
                                                   : std::string(document.substr(0, c.bytes));
    document.remove_prefix(c.bytes);
  }
  return out;
}

}  // namespace fascia
