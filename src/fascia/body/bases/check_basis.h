#pragma once

#include <string>

#include <fascia/base/error.h>

namespace fascia {

// Throws Error unless low <= found <= high.
inline void checkBasisNumber(const char* what, double found, double low, double high) {
  if (found >= low && found <= high) return;
  Issue issue{{},
              "basis: " + std::string(what) + ": found " + std::to_string(found) +
                  ", expected a number in [" + std::to_string(low) + ", " + std::to_string(high) +
                  "]",
              {}};
  throw Error(issue);
}

}  // namespace fascia
