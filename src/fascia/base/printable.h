#pragma once

#include <string>
#include <string_view>

namespace fascia {

// Text as it may stand on a person's terminal: control characters (of ASCII, of ISO 6429 and those
// that turn the direction of writing) and bytes that are no UTF-8 become escapes such as \n, \x1b
// or \u202e, so that a name out of a stranger's file moves no cursor and forges no line.
std::string printable(std::string_view text);

// The same for a JSON document, whose own line breaks stay: only \uXXXX is put in.
std::string printableJson(std::string_view document);

}  // namespace fascia
