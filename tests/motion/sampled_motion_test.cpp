#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <fascia/motion/sampled_motion.h>

namespace fascia {
namespace {

// Two joints and four frames, half a second apart. The second joint walks along x by 1, 2, 4 and 8
// m and turns about z by 0°, 90°, 180° and 270°; the first stays where it is.
SampledMotion walk(bool loop) {
  SampledMotion motion;
  motion.name = "walk";
  motion.rate_hz = 2;
  motion.loop = loop;
  motion.joints = {"root", "leg"};
  for (int f = 0; f < 4; ++f) {
    const auto half = static_cast<float>(f * kPi / 4);
    motion.rotation.push_back(Eigen::Quaternionf::Identity());
    motion.rotation.emplace_back(std::cos(half), 0.f, 0.f, std::sin(half));
    motion.translation_m.emplace_back(0.f, 3.f, 0.f);
    motion.translation_m.emplace_back(std::ldexp(1.f, f), 0.f, 0.f);
  }
  return motion;
}

double placeAt(const SampledMotion& motion, double time_s) {
  return sampleJoint(motion, 1, time_s).translation_m.x();
}
// In [0, 360).
double angleAt(const SampledMotion& motion, double time_s) {
  const Mat3 r = sampleJoint(motion, 1, time_s).rotation;
  const double angle = degrees(std::atan2(r(1, 0), r(0, 0)));
  return angle < -1e-3 ? angle + 360 : angle;
}

TEST(SampledMotion, GivesItsFramesAtTheirTimes) {
  for (const bool loop : {false, true}) {
    const SampledMotion motion = walk(loop);
    ASSERT_EQ(motion.frameCount(), 4u);
    for (int f = 0; f < 4; ++f) {
      EXPECT_NEAR(placeAt(motion, 0.5 * f), std::ldexp(1.0, f), 1e-6);
      EXPECT_NEAR(angleAt(motion, 0.5 * f), 90.0 * f, 1e-4);
      EXPECT_EQ(sampleJoint(motion, 0, 0.5 * f).translation_m, Vec3(0, 3, 0));
    }
  }
}

// One joint that moves along x and turns about z (radians) as two functions of time say.
template <class Place, class Angle>
SampledMotion sampled(int frames, double rate_hz, const Place& place, const Angle& angle) {
  SampledMotion motion;
  motion.rate_hz = rate_hz;
  motion.joints = {"root", "leg"};
  for (int f = 0; f < frames; ++f) {
    const double half = 0.5 * angle(f / rate_hz);
    motion.rotation.push_back(Eigen::Quaternionf::Identity());
    motion.rotation.emplace_back(static_cast<float>(std::cos(half)), 0.f, 0.f,
                                 static_cast<float>(std::sin(half)));
    motion.translation_m.emplace_back(0.f, 3.f, 0.f);
    motion.translation_m.emplace_back(static_cast<float>(place(f / rate_hz)), 0.f, 0.f);
  }
  return motion;
}

TEST(SampledMotion, KeepsEvenMotionEven) {
  const auto even = [](double t) { return 2 * t; };
  const SampledMotion motion = sampled(5, 10, even, even);
  for (double t = 0; t <= 0.4; t += 0.013) {
    EXPECT_NEAR(placeAt(motion, t), 2 * t, 1e-6);
    EXPECT_NEAR(angleAt(motion, t), degrees(2 * t), 0.01);
    const Mat3 r = sampleJoint(motion, 1, t).rotation;
    EXPECT_LT((r * r.transpose() - Mat3::Identity()).norm(), 1e-6);
  }
}

// Straight pieces would have second order.
TEST(SampledMotion, ConvergesWithThirdOrder) {
  const auto worst = [](int frames, double rate_hz) {
    const auto place = [](double t) { return std::sin(3 * t); };
    const auto angle = [](double t) { return 1.5 + std::sin(2 * t + 1); };
    const SampledMotion motion = sampled(frames, rate_hz, place, angle);
    double place_m = 0, angle_deg = 0;
    for (double t = 0.5; t < 1.5; t += 0.003) {
      place_m = std::max(place_m, std::abs(placeAt(motion, t) - place(t)));
      angle_deg = std::max(angle_deg, std::abs(angleAt(motion, t) - degrees(angle(t))));
    }
    return std::pair(place_m, angle_deg);
  };
  const auto [coarsePlace, coarseAngle] = worst(21, 10);
  const auto [finePlace, fineAngle] = worst(41, 20);
  EXPECT_LT(coarsePlace, 2e-3);
  EXPECT_GT(coarsePlace / finePlace, 6.5);
  EXPECT_GT(coarseAngle / fineAngle, 6.5);
}

TEST(SampledMotion, PassesItsFramesWithoutAKick) {
  const SampledMotion motion = walk(true);
  const double h = 5e-4;
  for (int f = 0; f < 4; ++f) {
    const double t = 0.5 * f;
    const double before = placeAt(motion, t) - placeAt(motion, t - h);
    const double after = placeAt(motion, t + h) - placeAt(motion, t);
    EXPECT_NEAR(before / h, after / h, 0.1) << f;  // straight pieces: 2, 4, 8 and −14 m/s
  }
}

TEST(SampledMotion, DoesNotSwingOverWhereItJumps) {
  const auto jump = [](double t) { return t < 0.25 ? 0.0 : 1.0; };
  const SampledMotion motion = sampled(6, 10, jump, jump);
  for (double t = 0; t <= 0.5; t += 0.007) {
    EXPECT_GE(placeAt(motion, t), 0);
    EXPECT_LE(placeAt(motion, t), 1);
    EXPECT_GE(angleAt(motion, t), 0);
    EXPECT_LE(angleAt(motion, t), degrees(1) + 1e-4);
  }
  EXPECT_EQ(placeAt(motion, 0.15), 0);
  EXPECT_EQ(placeAt(motion, 0.35), 1);
}

TEST(SampledMotion, TakesTheShortWayAlsoToTheOtherHemisphere) {
  SampledMotion motion = walk(false);
  const double angle = angleAt(motion, 0.25);
  EXPECT_NEAR(angle, 45, 2);
  motion.rotation[3].coeffs() *= -1;  // −q is the same turn
  EXPECT_NEAR(angleAt(motion, 0.25), angle, 1e-4);
}

TEST(SampledMotion, LoopsFromItsLastFrameToItsFirst) {
  const SampledMotion motion = walk(true);
  EXPECT_EQ(motion.duration_s(), 2);
  EXPECT_GT(placeAt(motion, 1.75), 1);
  EXPECT_LT(placeAt(motion, 1.75), 8);
  EXPECT_NEAR(angleAt(motion, 1.75), 315, 2);
  for (const double time : {0.0, 0.3, 1.2, 1.9}) {
    for (const double turns : {-3.0, -1.0, 1.0, 50.0}) {
      EXPECT_NEAR(placeAt(motion, time + 2 * turns), placeAt(motion, time), 1e-5);
      EXPECT_NEAR(angleAt(motion, time + 2 * turns), angleAt(motion, time), 1e-3);
    }
  }
}

TEST(SampledMotion, StandsStillBeforeItsFirstAndAfterItsLastFrame) {
  const SampledMotion motion = walk(false);
  EXPECT_EQ(motion.duration_s(), 1.5);
  EXPECT_EQ(placeAt(motion, -1e6), placeAt(motion, 0));
  EXPECT_EQ(placeAt(motion, 1.6), placeAt(motion, 1.5));
  EXPECT_EQ(placeAt(motion, 1e300), placeAt(motion, 1.5));
}

TEST(SampledMotion, OfOneFrameIsAPose) {
  for (const bool loop : {false, true}) {
    SampledMotion motion = walk(loop);
    motion.rotation.resize(2);
    motion.translation_m.resize(2);
    for (const double time : {-1.0, 0.0, 0.2, 7.3}) EXPECT_EQ(placeAt(motion, time), 1);
  }
}

TEST(SampledMotion, ReadsATimeThatIsNoNumberAsTheStart) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const bool loop : {false, true})
    for (const double time : {std::nan(""), infinity, -infinity})
      EXPECT_EQ(placeAt(walk(loop), time), 1);
}

// The number of frames is none that divides such times without rounding.
TEST(SampledMotion, StaysWithinItsFramesAtHugeTimes) {
  SampledMotion motion = walk(true);
  motion.rotation.resize(6);
  motion.translation_m.resize(6);
  for (const double time : {1.2345e17, 1.1e30, 1e300, 1.7e308}) {
    for (const double signedTime : {time, -time}) {
      EXPECT_GE(placeAt(motion, signedTime), 1) << signedTime;
      EXPECT_LE(placeAt(motion, signedTime), 4) << signedTime;
    }
  }
}

}  // namespace
}  // namespace fascia
