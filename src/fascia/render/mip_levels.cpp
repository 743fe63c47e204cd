#include <fascia/render/mip_levels.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fascia {
namespace {

constexpr std::size_t kLightSteps = 8192;  // fewer: dark levels of grey are skipped

// sRGB bytes to linear light, as whole numbers of kLightSteps, and back.
struct LightTables {
  std::array<std::uint32_t, 256> light;
  std::array<std::uint8_t, kLightSteps + 1> byte;

  LightTables() {
    for (std::size_t i = 0; i < light.size(); ++i) {
      const double s = static_cast<double>(i) / 255;
      const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
      light[i] = static_cast<std::uint32_t>(std::lround(linear * kLightSteps));
    }
    for (std::size_t i = 0; i < byte.size(); ++i) {
      const double c = static_cast<double>(i) / kLightSteps;
      const double s = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
      byte[i] = static_cast<std::uint8_t>(std::lround(255 * s));
    }
  }
};

// Visits each texel of the next level with the places of its four.
template <class Mean>
MipLevel halvedBy(const std::uint8_t* texels, int width, int height, int channels, Mean mean) {
  MipLevel level{std::max(1, width / 2), std::max(1, height / 2), {}};
  level.texels.reserve(static_cast<std::size_t>(level.width * level.height * channels));
  for (int y = 0; y < level.height; ++y)
    for (int x = 0; x < level.width; ++x)
      for (int c = 0; c < channels; ++c) {
        const auto at = [&](int dx, int dy) {
          const int u = std::min(2 * x + dx, width - 1), v = std::min(2 * y + dy, height - 1);
          return texels[(static_cast<std::ptrdiff_t>(v) * width + u) * channels + c];
        };
        level.texels.push_back(mean(c, std::array{at(0, 0), at(1, 0), at(0, 1), at(1, 1)}));
      }
  return level;
}

std::uint8_t plainMean(const std::array<std::uint8_t, 4>& four) {
  return static_cast<std::uint8_t>((four[0] + four[1] + four[2] + four[3] + 2) / 4);
}

}  // namespace

MipLevel halved(const std::uint8_t* texels, int width, int height, int channels) {
  return halvedBy(texels, width, height, channels,
                  [](int, const auto& four) { return plainMean(four); });
}

MipLevel halvedSrgb(const std::uint8_t* rgba, int width, int height) {
  static const LightTables tables;
  return halvedBy(rgba, width, height, 4, [](int channel, const auto& four) {
    if (channel == 3) return plainMean(four);
    std::uint32_t sum = 2;
    for (const std::uint8_t b : four) sum += tables.light[b];
    return tables.byte[sum / 4];
  });
}

}  // namespace fascia
