#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fascia {

// A picture: 8-bit sRGB with alpha, rows from the top.
struct Pixels {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  // height x width x 4

  const std::uint8_t* at(int x, int y) const {
    return rgba.data() + 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(x));
  }
};

}  // namespace fascia
