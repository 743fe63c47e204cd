#include <fascia/render/mip_levels.h>

#include <gtest/gtest.h>

namespace fascia {
namespace {

TEST(MipLevels, KeepWhatIsTheSameEverywhere) {
  for (int grey = 0; grey < 256; ++grey) {
    const std::vector<std::uint8_t> texels(16, static_cast<std::uint8_t>(grey));
    const MipLevel srgb = halvedSrgb(texels.data(), 2, 2), plain = halved(texels.data(), 4, 4, 1);
    EXPECT_EQ(srgb.texels, std::vector<std::uint8_t>(4, texels[0]));
    EXPECT_EQ(plain.texels, std::vector<std::uint8_t>(4, texels[0]));
  }
}

TEST(MipLevels, MixColoursAsLightAndAlphaAsNumbers) {
  const std::vector<std::uint8_t> texels{0, 0, 0, 0, 255, 255, 255, 100};
  const MipLevel level = halvedSrgb(texels.data(), 2, 1);
  EXPECT_EQ(level.width, 1);
  EXPECT_EQ(level.height, 1);
  EXPECT_EQ(level.texels, (std::vector<std::uint8_t>{188, 188, 188, 50}));  // sRGB of light 1/2
}

TEST(MipLevels, OfOddSidesEndInOneTexel) {
  MipLevel level{5, 3, std::vector<std::uint8_t>(15, 7)};
  level.texels.back() = 200;
  level = halved(level.texels.data(), 5, 3, 1);
  EXPECT_EQ(level.texels, (std::vector<std::uint8_t>{7, 7}));
  level = halved(level.texels.data(), level.width, level.height, 1);
  EXPECT_EQ(level.width, 1);
  EXPECT_EQ(level.height, 1);
  EXPECT_EQ(level.texels, std::vector<std::uint8_t>{7});
}

}  // namespace
}  // namespace fascia
