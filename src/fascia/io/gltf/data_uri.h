#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fascia {

// "data:application/octet-stream;base64,AAEC…" -> bytes; false if it is no such thing.
bool decodeDataUri(std::string_view uri, std::vector<std::uint8_t>& bytes);

std::string decodePercents(std::string_view uri);  // "my%20fox.bin" -> "my fox.bin"

}  // namespace fascia
