#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fascia/base/random.h>
#include <fascia/motion/clip.h>
#include <gtest/gtest.h>

#include "keys.h"

namespace fascia {
namespace {

using test::key;

constexpr double kSmall_s = 1e-6;

// One-sided rates by second-order finite differences.
double rateAfter(const KeySpline& s, double t) {
  const double h = kSmall_s;
  return (-3 * s.at(t).value + 4 * s.at(t + h).value - s.at(t + 2 * h).value) / (2 * h);
}
double rateBefore(const KeySpline& s, double t) {
  const double h = kSmall_s;
  return (3 * s.at(t).value - 4 * s.at(t - h).value + s.at(t - 2 * h).value) / (2 * h);
}

std::vector<Key> randomKeys(std::uint64_t seed, double continuity) {
  Random random(seed);
  std::vector<Key> keys;
  double time_s = random.uniform(0, 1);
  for (int i = 0; i < 8; ++i) {
    keys.push_back(
        {time_s, random.uniform(-2, 2), random.uniform(-1, 1), continuity, random.uniform(-1, 1)});
    time_s += random.uniform(0.05, 1.5);
  }
  return keys;
}

TEST(KeySpline, PassesThroughEveryKey) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const std::vector<Key> keys = randomKeys(seed, 0.3);
    const KeySpline spline(keys, 0);
    for (const Key& k : keys) EXPECT_NEAR(spline.at(k.time_s).value, k.value, 1e-12);
  }
}

TEST(KeySpline, RateIsTheDerivativeOfTheValue) {
  const std::vector<Key> keys = randomKeys(3, -0.4);
  const KeySpline spline(keys, 0);
  double largest = 0;
  for (double t = keys.front().time_s + 0.013; t < keys.back().time_s; t += 0.0517) {
    const double h = 1e-5;
    const double difference = (spline.at(t + h).value - spline.at(t - h).value) / (2 * h);
    EXPECT_NEAR(spline.at(t).rate, difference, 1e-6);
    largest = std::max(largest, std::abs(difference));
  }
  EXPECT_GT(largest, 0.5);
}

TEST(KeySpline, CatmullRomTangentIsTheSlopeOfTheChord) {
  const KeySpline spline({key(0, 1), key(1, 3), key(2, 2), key(3, 7)}, 0);
  EXPECT_NEAR(spline.at(1).rate, (2.0 - 1.0) / 2, 1e-12);
  EXPECT_NEAR(spline.at(2).rate, (7.0 - 3.0) / 2, 1e-12);
}

// Kochanek & Bartels' DS and DD for even unit spacing, written out.
TEST(KeySpline, TangentsFollowTheFormulaOfKochanekAndBartels) {
  const double t = 0.3, c = -0.6, b = 0.4;
  const double p0 = 1, p1 = 4, p2 = 2;
  const KeySpline spline({key(0, p0), {1, p1, t, c, b}, key(2, p2)}, 0);
  const double ds =
      (1 - t) * (1 - c) * (1 + b) / 2 * (p1 - p0) + (1 - t) * (1 + c) * (1 - b) / 2 * (p2 - p1);
  const double dd =
      (1 - t) * (1 + c) * (1 + b) / 2 * (p1 - p0) + (1 - t) * (1 - c) * (1 - b) / 2 * (p2 - p1);
  ASSERT_GT(std::abs(ds - dd), 1);
  EXPECT_NEAR(rateBefore(spline, 1), ds, 1e-6);
  EXPECT_NEAR(rateAfter(spline, 1), dd, 1e-6);
}

TEST(KeySpline, TensionOneStopsAtTheKey) {
  const KeySpline spline({key(0, 0), {1, 1, 1, 0, 0}, key(2, 5)}, 0);
  EXPECT_NEAR(rateBefore(spline, 1), 0, 1e-5);
  EXPECT_NEAR(rateAfter(spline, 1), 0, 1e-5);
  const KeySpline loose({key(0, 0), {1, 1, -1, 0, 0}, key(2, 5)}, 0);
  EXPECT_NEAR(loose.at(1).rate, 2 * 2.5, 1e-12);  // twice Catmull–Rom
}

TEST(KeySpline, ContinuityMinusOneMakesACornerOfTwoStraightLines) {
  const Key corner{1, 2, 0, -1, 0};
  const KeySpline spline({{0, 0, 0, -1, 0}, corner, {2, -3, 0, -1, 0}}, 0);
  for (double s : {0.1, 0.5, 0.8}) {
    EXPECT_NEAR(spline.at(s).value, 2 * s, 1e-12);
    EXPECT_NEAR(spline.at(1 + s).value, 2 - 5 * s, 1e-12);
  }
  EXPECT_NEAR(rateBefore(spline, 1), 2, 1e-6);
  EXPECT_NEAR(rateAfter(spline, 1), -5, 1e-6);
}

TEST(KeySpline, BiasTurnsTheTangentTowardsOneNeighbour) {
  const auto rateWithBias = [](double bias) {
    return KeySpline({key(0, 0), {1, 3, 0, 0, bias}, key(2, 4)}, 0).at(1).rate;
  };
  EXPECT_NEAR(rateWithBias(1), 3, 1e-12);   // the slope before
  EXPECT_NEAR(rateWithBias(0), 2, 1e-12);   // the mean
  EXPECT_NEAR(rateWithBias(-1), 1, 1e-12);  // the slope after
}

TEST(KeySpline, HasNoJumpInRateWhereContinuityIsZero) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const std::vector<Key> keys = randomKeys(seed, 0);
    const KeySpline spline(keys, 0);
    for (const Key& k : keys) {  // also at the ends, where the constant begins
      EXPECT_NEAR(rateBefore(spline, k.time_s), rateAfter(spline, k.time_s), 1e-3);
    }
  }
}

TEST(KeySpline, UnevenSpacingKeepsOvershootSmall) {
  // A short steep interval before a long flat one. Averaging the slopes would leave the middle key
  // with 5 per second and overshoot by 4/27 · 5; the chord leaves it with 1/1.1.
  const KeySpline spline({key(0, 0), key(0.1, 1), key(1.1, 1)}, 0);
  double highest = 0;
  for (double t = 0; t <= 1.1; t += 0.001) highest = std::max(highest, spline.at(t).value);
  EXPECT_GT(highest, 1);
  EXPECT_LE(highest, 1 + 4.0 / 27 / 1.1 + 1e-9);
}

TEST(KeySpline, IsConstantOutsideItsKeys) {
  const KeySpline spline({key(1, 5), key(2, 6), key(3, 9)}, 0);
  for (double t : {-1e300, -4.0, 0.999}) {
    EXPECT_EQ(spline.at(t).value, 5);
    EXPECT_EQ(spline.at(t).rate, 0);
  }
  for (double t : {3.0, 8.0, 1e300}) {
    EXPECT_EQ(spline.at(t).value, 9);
    EXPECT_EQ(spline.at(t).rate, 0);
  }
}

TEST(KeySpline, OneKeyIsAConstant) {
  for (double period_s : {0.0, 2.0}) {
    const KeySpline spline({key(0.5, 7)}, period_s);
    for (double t : {0.0, 0.5, 3.7}) {
      EXPECT_EQ(spline.at(t).value, 7);
      EXPECT_EQ(spline.at(t).rate, 0);
    }
  }
}

TEST(KeySpline, LoopRepeatsWithItsPeriod) {
  const KeySpline spline({key(0, 0), key(0.5, 1), key(1.2, -2), key(2, 0)}, 2);
  for (double t : {0.1, 0.77, 1.3, 1.999}) {
    for (int turns : {-3, 1, 50}) {
      EXPECT_NEAR(spline.at(t + 2 * turns).value, spline.at(t).value, 1e-9);
      EXPECT_NEAR(spline.at(t + 2 * turns).rate, spline.at(t).rate, 1e-9);
    }
  }
}

TEST(KeySpline, LoopHasNoJumpAtItsSeam) {
  const KeySpline closed({key(0, 0.4), key(0.5, 1), key(1.2, -2), key(2, 0.4)}, 2);
  const KeySpline open({key(0, 0.4), key(0.5, 1), key(1.2, -2)}, 2);
  EXPECT_GT(std::abs(closed.at(0).rate), 0.5);
  EXPECT_NEAR(rateBefore(closed, 2), rateAfter(closed, 0), 1e-3);
  EXPECT_NEAR(closed.at(2).value, 0.4, 1e-12);
  for (double t = 0; t < 2; t += 0.1) {  // the repeated first key says nothing new
    EXPECT_NEAR(closed.at(t).value, open.at(t).value, 1e-12);
  }
}

// With a phase, so that the curve bends at the seam and a tangent from one side only would show.
TEST(KeySpline, EvenlySampledLoopOfASineIsTheSine) {
  const auto sine = [](double t) { return std::sin(2 * std::numbers::pi * t / 4 + 1); };
  std::vector<Key> keys;
  for (int i = 0; i < 32; ++i) keys.push_back(key(4.0 * i / 32, sine(4.0 * i / 32)));
  const KeySpline spline(keys, 4);
  for (double t = -1; t < 9; t += 0.0371) EXPECT_NEAR(spline.at(t).value, sine(t), 1e-3);
}

TEST(KeySpline, TimeThatIsNotFiniteReadsAsTheFirstKey) {
  for (double period_s : {0.0, 3.0}) {
    const KeySpline spline({key(0, 2), key(1, 3)}, period_s);
    for (double t :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      EXPECT_EQ(spline.at(t).value, 2);
      EXPECT_EQ(spline.at(t).rate, 0);
    }
  }
  EXPECT_EQ(KeySpline().at(1).value, 0);
}

}  // namespace
}  // namespace fascia
