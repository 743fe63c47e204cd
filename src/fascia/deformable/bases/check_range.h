#pragma once

#include <string>

#include <fascia/base/error.h>

namespace fascia {

// Throws Error unless low <= found <= high; `where` and `what` say which number it is.
inline void checkRange(const char* where, const char* what, double found, double low, double high) {
  if (found >= low && found <= high) return;  // false for NaN
  Issue issue{{},
              std::string(where) + ": " + what + ": found " + std::to_string(found) +
                  ", expected a number in [" + std::to_string(low) + ", " + std::to_string(high) +
                  "]",
              {}};
  throw Error(issue);
}

}  // namespace fascia
