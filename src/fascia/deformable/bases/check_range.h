#pragma once

#include <string>

#include <fascia/base/tunable.h>

namespace fascia {

// Throws Error unless low <= found <= high; `where` and `what` say which number it is.
inline void checkRange(const char* where, const char* what, double found, double low, double high) {
  const NumberRange range{low, high};
  if (range.contains(found)) return;  // false for NaN
  Issue issue{{},
              std::string(where) + ": " + what + ": found " + shortestText(found) + ", expected " +
                  range.text(),
              {}};
  throw Error(issue);
}

}  // namespace fascia
