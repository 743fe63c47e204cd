#include <fascia/render/overlay.h>

#include <gtest/gtest.h>

#include <cmath>

#include <fascia/render/glyphs.h>

namespace fascia {
namespace {

Pixels paper(int width, int height) {
  Pixels pixels{width, height, {}};
  pixels.rgba.assign(4 * static_cast<std::size_t>(width * height), 255);
  return pixels;
}

// Ink on white paper, in pixels covered.
double inkOn(const Pixels& pixels) {
  double sum = 0;
  for (std::size_t i = 0; i < pixels.rgba.size(); i += 4) sum += 1 - pixels.rgba[i] / 255.0;
  return sum;
}

const Ink kBlack{{0, 0, 0}, 1};

TEST(Overlay, BoxCoversItsArea) {
  Pixels pixels = paper(60, 40);
  fillBox(pixels, {10.25, 5.5, 30, 20}, kBlack);
  EXPECT_NEAR(inkOn(pixels), 30 * 20, 2);
}

TEST(Overlay, RoundedCornersLeaveOutWhatACircleDoes) {
  Pixels pixels = paper(100, 100);
  fillBox(pixels, {10, 10, 80, 80}, kBlack, 20);
  EXPECT_NEAR(inkOn(pixels), 80 * 80 - (4 - std::acos(-1.0)) * 20 * 20, 4);
}

TEST(Overlay, RingCoversLengthTimesThickness) {
  Pixels pixels = paper(120, 120);
  drawRing(pixels, 60.3, 59.6, 40, 3, kBlack);
  EXPECT_NEAR(inkOn(pixels), 2 * std::acos(-1.0) * 40 * 3, 8);
}

TEST(Overlay, OpacityMixesWithWhatIsBelow) {
  Pixels pixels = paper(10, 10);
  fillBox(pixels, {0, 0, 10, 10}, {{0, 0.5f, 1}, 0.5f});
  EXPECT_NEAR(pixels.at(5, 5)[0], 128, 1);
  EXPECT_NEAR(pixels.at(5, 5)[1], 191, 1);
  EXPECT_EQ(pixels.at(5, 5)[2], 255);
  EXPECT_EQ(pixels.at(5, 5)[3], 255);
}

TEST(Overlay, TextKeepsToItsLineAndWidth) {
  Pixels pixels = paper(400, 60);
  const TextStyle style{.size = 30, .ink = kBlack};
  const std::string text = "Hamburgefontsiv {gy}";
  const double end = drawText(pixels, 20, 40, text, style);
  EXPECT_NEAR(end, 20 + textWidth(text, style), 1e-9);
  ASSERT_GT(inkOn(pixels), 100);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 400; ++x)
      if (pixels.at(x, y)[0] < 255) {
        EXPECT_GE(x, 17) << y;
        EXPECT_LE(x, end + 3) << y;
        EXPECT_GE(y, 14) << x;
        EXPECT_LE(y, 50) << x;
      }
}

TEST(Overlay, WhatFallsOutsideIsLeftOut) {
  Pixels pixels = paper(20, 20);
  drawText(pixels, -30, 5, "far too long for this", {.size = 24, .ink = kBlack});
  drawRing(pixels, 20, 20, 15, 4, kBlack);
  fillBox(pixels, {-5, -5, 100, 8}, kBlack, 2);
  EXPECT_GT(inkOn(pixels), 20);
}

TEST(Overlay, TextIsReadAsUtf8) {
  const TextStyle style;
  EXPECT_EQ(&glyphOf(U'°'), &glyphOf(char32_t{0xB0}));
  EXPECT_GT(textWidth("120°", style), textWidth("120", style));
  EXPECT_LT(textWidth("°", style), textWidth("\xB0\xB0", style));  // two broken bytes: two boxes
  EXPECT_EQ(textWidth("狐", style), textWidth("\xB0", style));     // none of ours: one box
  EXPECT_EQ(textWidth("", style), 0);
}

TEST(Overlay, EveryPrintableAsciiCharacterHasALetterOfItsOwn) {
  const Glyph& box = glyphOf(U'狐');
  for (char32_t c = 33; c < 127; ++c) {
    EXPECT_NE(&glyphOf(c), &box) << static_cast<char>(c);
    EXPECT_FALSE(glyphOf(c).lines.empty()) << static_cast<char>(c);
    for (char32_t other = 33; other < c; ++other) {
      const auto& a = glyphOf(c).lines;
      const auto& b = glyphOf(other).lines;
      const bool same = a.size() == b.size() &&
                        std::equal(a.begin(), a.end(), b.begin(), [](const auto& x, const auto& y) {
                          return x.from == y.from && x.to == y.to;
                        });
      EXPECT_FALSE(same) << static_cast<char>(c) << " looks like " << static_cast<char>(other);
    }
  }
}

// The curves are conics: the letter o is an ellipse, not about one.
TEST(Overlay, RoundLettersAreEllipses) {
  for (const Glyph::Line& line : glyphOf(U'O').lines) {
    const double x = (line.from.x() - 31) / 31, y = (line.from.y() - 35) / 35;
    EXPECT_NEAR(x * x + y * y, 1, 1e-5);
  }
}

TEST(Overlay, PlacesPiecesWhereTheyBelong) {
  Pixels picture = paper(30, 20), piece{10, 5, {}};
  piece.rgba.assign(4 * 10 * 5, 7);
  place(piece, 20, 15, picture);
  EXPECT_EQ(picture.at(20, 15)[0], 7);
  EXPECT_EQ(picture.at(29, 19)[3], 7);
  EXPECT_EQ(picture.at(19, 15)[0], 255);
  EXPECT_EQ(picture.at(20, 14)[0], 255);
  placeColumns(piece, 3, 0, 0, picture);
  EXPECT_EQ(picture.at(2, 4)[0], 7);
  EXPECT_EQ(picture.at(3, 4)[0], 255);
}

}  // namespace
}  // namespace fascia
