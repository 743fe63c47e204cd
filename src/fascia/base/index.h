#pragma once

#include <cstddef>

#include <fascia/base/assert.h>

namespace fascia {

// A number that counts from 0 as an index of the standard library's containers. File formats and
// Eigen count in signed numbers.
constexpr std::size_t at(int i) {
  FASCIA_ASSERT(i >= 0, "indices count from 0");
  return static_cast<std::size_t>(i);
}

}  // namespace fascia
