#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <fascia/base/error.h>
#include <fascia/base/parallel.h>
#include <fascia/render/edge_filter.h>

namespace fascia {
namespace {

constexpr int kSide = 96;
constexpr PixelBox kAll{0, 0, kSide, kSide};

// A grey picture of a function of the place, (0, 0) = top left.
template <class Shade>
Pixels pictureOf(const Shade& shade) {
  Pixels picture{kSide, kSide, {}};
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const auto level = static_cast<std::uint8_t>(std::lround(shade(x + 0.5, y + 0.5)));
      picture.rgba.insert(picture.rgba.end(), {level, level, level, 255});
    }
  return picture;
}

// Dark below the line through the middle, at (cos, sin) of the angle; bright above.
struct HalfPlane {
  double angle_rad;
  double distance(double x, double y) const {
    return (y - 0.5 * kSide) * std::cos(angle_rad) - (x - 0.5 * kSide) * std::sin(angle_rad);
  }
  double sampled(double x, double y) const { return distance(x, y) > 0 ? 40 : 220; }
  double covered(double x, double y) const {  // 16 x 16 samples
    double sum = 0;
    for (int j = 0; j < 16; ++j)
      for (int i = 0; i < 16; ++i) sum += sampled(x + (i - 7.5) / 16, y + (j - 7.5) / 16);
    return sum / 256;
  }
};

// Away from the picture's rim, where a step's end is not seen.
double squaredError(const Pixels& a, const Pixels& b) {
  double sum = 0;
  for (int y = 12; y < kSide - 12; ++y)
    for (int x = 12; x < kSide - 12; ++x) {
      const double off = a.at(x, y)[0] - b.at(x, y)[0];
      sum += off * off;
    }
  return sum;
}

TEST(EdgeFilter, TakesTheStairsOffSlantedEdges) {
  for (const double angle_deg : {7., 20., 33., 60., 78., 85., 110., 155., 200.}) {
    const HalfPlane plane{angle_deg * 3.14159265358979 / 180};
    const auto exact = pictureOf([&](double x, double y) { return plane.covered(x, y); });
    const auto stairs = pictureOf([&](double x, double y) { return plane.sampled(x, y); });
    Pixels smooth = stairs;
    smoothEdges(smooth, kAll);
    EXPECT_LT(squaredError(smooth, exact), 0.25 * squaredError(stairs, exact)) << angle_deg;
  }
}

TEST(EdgeFilter, KeepsEdgesAlongRowsAndColumns) {
  for (const bool level : {false, true}) {
    const Pixels sharp =
        pictureOf([&](double x, double y) { return (level ? y : x) < 41 ? 30. : 200.; });
    Pixels smooth = sharp;
    smoothEdges(smooth, kAll);
    EXPECT_EQ(smooth.rgba, sharp.rgba);
  }
}

TEST(EdgeFilter, KeepsShading) {
  const Pixels soft = pictureOf([](double x, double y) { return 20 + 1.5 * x + 0.5 * y; });
  Pixels smooth = soft;
  smoothEdges(smooth, kAll);
  EXPECT_EQ(smooth.rgba, soft.rgba);
}

TEST(EdgeFilter, TakesSinglePixelsOut) {
  Pixels picture = pictureOf([](double, double) { return 180.; });
  const Pixels clean = picture;
  picture.rgba[4 * (30 * kSide + 50)] = picture.rgba[4 * (30 * kSide + 50) + 1] = 20;
  smoothEdges(picture, kAll);
  EXPECT_EQ(picture.rgba, clean.rgba);
}

TEST(EdgeFilter, ChangesNothingOutsideOfItsBox) {
  const HalfPlane plane{0.3};
  const auto stairs = pictureOf([&](double x, double y) { return plane.sampled(x, y); });
  const PixelBox box{20, 30, 60, 70};
  Pixels smooth = stairs;
  smoothEdges(smooth, box);
  int inside = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const bool changed = smooth.at(x, y)[0] != stairs.at(x, y)[0];
      const bool in = x >= box.left && x < box.right && y >= box.top && y < box.bottom;
      inside += changed ? 1 : 0;
      EXPECT_TRUE(in || !changed) << x << " " << y;
    }
  EXPECT_GT(inside, 10);
}

TEST(EdgeFilter, TakesAnyBoxAndRefusesBrokenPictures) {
  Pixels picture = pictureOf([](double x, double y) { return x * y > 900 ? 20. : 200.; });
  for (const PixelBox& box :
       {PixelBox{-50, -50, 500, 500}, {40, 40, 40, 80}, {80, 80, 20, 20}, {-9, -9, -3, -3}})
    EXPECT_NO_THROW(smoothEdges(picture, box));
  for (const int side : {0, 1, 2}) {
    Pixels tiny{side, side, std::vector<std::uint8_t>(static_cast<std::size_t>(4 * side * side))};
    EXPECT_NO_THROW(smoothEdges(tiny, kAll));
  }
  picture.rgba.pop_back();
  EXPECT_THROW(smoothEdges(picture, kAll), Error);
}

TEST(EdgeFilter, GivesTheSameBytesOnAnyNumberOfThreads) {
  const HalfPlane plane{1.1};
  const auto stairs = pictureOf([&](double x, double y) { return plane.sampled(x, y); });
  Pixels one = stairs, many = stairs;
  {
    const ThreadLimit limit(1);
    smoothEdges(one, kAll);
  }
  {
    const ThreadLimit limit(4);
    smoothEdges(many, kAll);
  }
  EXPECT_EQ(one.rgba, many.rgba);
}

}  // namespace
}  // namespace fascia
