#include <fascia/flesh/clip_source.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "arm.h"

namespace fascia {
namespace {

TEST(ClipSource, SaysWhatTheClipSaysBitForBit) {
  const test::Arm arm;
  const BoundClip clip = test::flexClip(arm);
  const ClipSource source(arm.skeleton, arm.morphs, clip);
  EXPECT_EQ(source.info().name, "flex");
  EXPECT_EQ(source.info().duration_s, 2);
  EXPECT_TRUE(source.info().loop);
  PostureSample sample;
  Posture posture;
  std::vector<Flesh::ParameterOverride> parameters;
  for (const double time_s : {0.3, 1.7, -4.0, 0.3}) {
    source.sample(time_s, sample);
    samplePosture(clip, arm.skeleton, time_s, posture);
    sampleParameters(clip, time_s, parameters);
    EXPECT_EQ(sample.posture.values, posture.values);
    EXPECT_EQ(sample.posture.rates, posture.rates);
    ASSERT_EQ(sample.parameters.size(), 1u);
    EXPECT_EQ(sample.parameters[0].value, parameters[0].value);
    EXPECT_EQ(sample.parameters[0].rate, parameters[0].rate);
    // What is fit already stays as it is.
    admit(arm.figure(), {}, sample);
    EXPECT_EQ(sample.posture.values, posture.values);
    EXPECT_EQ(sample.posture.rates, posture.rates);
    EXPECT_EQ(sample.parameters.size(), 1u);
  }
}

TEST(PostureSource, IsAskedForNothingThatWouldBreakPosing) {
  const test::Arm arm;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const SolidId thumb = arm.id("thumb");
  PostureSample sample;
  sample.posture = arm.moving();
  sample.posture.values[3] = nan;
  sample.posture.rates[0] = HUGE_VAL;
  sample.posture.rotations = {{JointId(77), Quat::Identity(), Vec3::Zero()}};
  sample.parameters = {{SolidId(99), 0, 1, 0},   {SolidId(), 0, 1, 0},  {thumb, 99, 1, 0},
                       {thumb, -1, 1, 0},        {thumb, 0, 1, 0, nan}, {thumb, 0, 1, 0, 2},
                       {thumb, 0, 0.4, 0.1, 0.5}};
  admit(arm.figure(), {}, sample);
  EXPECT_EQ(sample.posture.values[3], 0);
  EXPECT_EQ(sample.posture.rates[0], 0);
  EXPECT_TRUE(sample.posture.rotations.empty());
  ASSERT_EQ(sample.parameters.size(), 1u);
  EXPECT_EQ(sample.parameters[0].value, 0.4);
}

TEST(ParameterOverride, ReplacesByItsWeight) {
  const test::Arm arm;
  const SolidId ball = arm.id("ball");
  PosedFlesh posed;
  const auto radius = [&](std::vector<Flesh::ParameterOverride> overrides) {
    arm.pose(arm.moving(), posed, overrides);
    return posed.solid(ball).parameter(0);
  };
  const double driven = radius({});
  ASSERT_GT(driven, 0.051);  // the elbow swells it
  EXPECT_EQ(radius({{ball, 0, 0.08, 0}}), 0.08);
  EXPECT_NEAR(radius({{ball, 0, 0.08, 0, 0.25}}), 0.75 * driven + 0.25 * 0.08, 1e-15);
  EXPECT_EQ(radius({{ball, 0, 0.08, 0, 0}}), driven);
  // One on top of another.
  EXPECT_NEAR(radius({{ball, 0, 0.08, 0}, {ball, 0, 0.04, 0, 0.5}}), 0.06, 1e-15);
}

TEST(ParameterOverride, SwellsAsItsWeightGrows) {
  const test::Arm arm;
  const SolidId ball = arm.id("ball");
  const Posture posture = arm.skeleton.restPosture();
  const auto posedAt = [&](double time_s, PosedFlesh& out) {
    arm.pose(posture, out,
             std::vector<Flesh::ParameterOverride>{
                 {ball, 0, 0.08 + 0.1 * time_s, 0.1, 0.4 + 2 * time_s, 2}});
  };
  PosedFlesh now, before, after;
  posedAt(0, now), posedAt(-1e-4, before), posedAt(1e-4, after);
  const double growth = (after.solid(ball).parameter(0) - before.solid(ball).parameter(0)) / 2e-4;
  const Vec3 pole = now.frame(ball).point({0, 0, now.solid(ball).parameter(0)});
  VectorArray point = test::toArray({pole}), velocity(1);
  now.velocity(ball, view(point, 0, 1), view(velocity, 0, 1));
  ASSERT_GT(growth, 0.05);
  EXPECT_NEAR(test::at(velocity, 0).norm(), growth, 1e-4);
}

}  // namespace
}  // namespace fascia
