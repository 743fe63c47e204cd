#pragma once

#include <cstddef>

namespace fascia {

// A number that counts from 0 as an index of the standard library's containers. File formats and
// Eigen count in signed numbers.
constexpr std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace fascia
