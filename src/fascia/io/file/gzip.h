#pragma once

#include <cstddef>
#include <string>

namespace fascia {

// The whole file, unpacked if it is a gzip file (by its first bytes, not by its name). Throws
// Error: unreadable, damaged, or larger than maxBytes once unpacked.
std::string readFileUnpacked(const std::string& path, std::size_t maxBytes);

}  // namespace fascia
