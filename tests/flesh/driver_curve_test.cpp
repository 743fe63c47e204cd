#include <cmath>

#include <fascia/base/random.h>
#include <fascia/flesh/driver_curve.h>
#include <gtest/gtest.h>

namespace fascia {
namespace {

using Interpolation = DriverDef::Interpolation;
using Points = std::vector<DriverDef::Point>;

Points randomRising(std::uint64_t seed) {
  Random random(seed);
  Points points;
  double x = random.uniform(-2, 0), y = random.uniform(-1, 1);
  for (int i = 0; i < 7; ++i) {
    points.push_back({x, y});
    x += random.uniform(0.01, 1);
    y += std::pow(random.uniform(), 4);  // flat here, steep there
  }
  return points;
}

TEST(DriverCurve, HitsItsPoints) {
  for (Interpolation kind : {Interpolation::smooth, Interpolation::piecewise}) {
    const Points points = randomRising(4);
    const DriverCurve curve(points, kind);
    for (const auto& p : points) EXPECT_NEAR(curve.at(p.jointValue).parameter, p.parameter, 1e-12);
  }
}

TEST(DriverCurve, IsMonotoneWhereItsPointsAre) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Points points = randomRising(seed);
    const DriverCurve curve(points, Interpolation::smooth);
    double previous = -1e9;
    for (double x = points.front().jointValue - 0.1; x < points.back().jointValue + 0.1;
         x += 1e-3) {
      const double y = curve.at(x).parameter;
      EXPECT_GE(y, previous - 1e-12) << "seed " << seed << " at " << x;
      previous = y;
    }
  }
}

TEST(DriverCurve, DoesNotOvershootAPeak) {
  const DriverCurve curve({{0, 1}, {1, 3}, {1.1, 1}, {3, 1}}, Interpolation::smooth);
  for (double x = -0.5; x < 3.5; x += 0.001) {
    EXPECT_LE(curve.at(x).parameter, 3 + 1e-12);
    EXPECT_GE(curve.at(x).parameter, 1 - 1e-12);
  }
}

TEST(DriverCurve, SlopeIsTheDerivative) {
  double steepest = 0;
  for (Interpolation kind : {Interpolation::smooth, Interpolation::piecewise}) {
    const Points points = randomRising(9);
    const DriverCurve curve(points, kind);
    for (double x = points.front().jointValue - 0.2; x < points.back().jointValue; x += 0.0123) {
      const double h = 1e-6;
      const double before = (curve.at(x).parameter - curve.at(x - h).parameter) / h;
      const double after = (curve.at(x + h).parameter - curve.at(x).parameter) / h;
      if (std::abs(before - after) > 1e-3) continue;  // astride a corner
      EXPECT_NEAR(curve.at(x).slope, (before + after) / 2, 1e-5);
      steepest = std::max(steepest, std::abs(after));
    }
  }
  EXPECT_GT(steepest, 0.2);
}

TEST(DriverCurve, SmoothHasNoJumpInSlope) {
  const Points points = randomRising(5);
  const DriverCurve curve(points, Interpolation::smooth);
  for (const auto& p : points) {
    EXPECT_NEAR(curve.at(p.jointValue - 1e-7).slope, curve.at(p.jointValue + 1e-7).slope, 1e-3);
  }
}

TEST(DriverCurve, IsConstantOutside) {
  for (Interpolation kind : {Interpolation::smooth, Interpolation::piecewise}) {
    const DriverCurve curve({{0, 5}, {1, 7}}, kind);
    EXPECT_EQ(curve.at(-3).parameter, 5);
    EXPECT_EQ(curve.at(-3).slope, 0);
    EXPECT_EQ(curve.at(8).parameter, 7);
    EXPECT_EQ(curve.at(8).slope, 0);
  }
}

TEST(DriverCurve, PiecewiseIsStraightBetweenPoints) {
  const DriverCurve curve({{0, 0}, {1, 2}, {3, 1}}, Interpolation::piecewise);
  EXPECT_NEAR(curve.at(0.25).parameter, 0.5, 1e-15);
  EXPECT_NEAR(curve.at(2).parameter, 1.5, 1e-15);
  EXPECT_NEAR(curve.at(2).slope, -0.5, 1e-15);
}

}  // namespace
}  // namespace fascia
