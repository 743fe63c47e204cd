#pragma once

#include <cstdint>
#include <vector>

namespace fascia {

// A picture of `channels` bytes per texel, rows one after the other.
struct MipLevel {
  int width = 0, height = 0;
  std::vector<std::uint8_t> texels;
};

// The next smaller level: means of two by two texels; of an odd side the last row or column counts
// once more. A driver's own levels are several times as slow where that is a processor.
MipLevel halved(const std::uint8_t* texels, int width, int height, int channels);
// The same of sRGB with alpha, whose colours mix as light does.
MipLevel halvedSrgb(const std::uint8_t* rgba, int width, int height);

}  // namespace fascia
