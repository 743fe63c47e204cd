#include <fascia/flesh/bind.h>
#include <fascia/flesh/clip_source.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "arm.h"

namespace fascia {
namespace {

using testing::ElementsAre;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

test::Arm faceArm() {
  test::Arm arm;
  arm.morphs = Morphs({{"smile", 0}, {"frown", 0.25}, {"blink", 0}});
  return arm;
}

MotionDef grin(std::vector<Key> keys, const std::string& morph = "smile") {
  MotionDef motion{"grin", 2, false, {}};
  motion.tracks = {{TrackDef::Target::morph, morph, "", std::move(keys)}};
  return motion;
}

TEST(Morphs, AreMadeFitWhateverASourceSays) {
  const Morphs morphs = faceArm().morphs;
  MorphPose pose{{kNan, 0.5}, {1, HUGE_VAL}};
  morphs.admit(pose);
  EXPECT_THAT(pose.weights, ElementsAre(0, 0.5, 0));
  EXPECT_THAT(pose.rates, ElementsAre(0, 0, 0));
  pose = {{1, -99, 99, 7, 7}, {3, 3, 3, 3}};  // of morphs that there are not, too
  morphs.admit(pose);
  EXPECT_THAT(pose.weights, ElementsAre(1, -kMostMorphWeight, kMostMorphWeight));
  EXPECT_THAT(pose.rates, ElementsAre(3, 0, 0));
  pose = {};
  morphs.admit(pose);
  EXPECT_THAT(pose.weights, ElementsAre(0, 0.25, 0));
}

TEST(Morphs, RestForASourceThatKnowsOfNone) {
  struct Still final : PostureSource {
    explicit Still(Posture p) : posture(std::move(p)) {}
    void sample(double, PostureSample& out) const override {
      out.posture = posture;
      out.parameters.clear();
    }
    Posture posture;
  };
  const test::Arm arm = faceArm();
  PostureSample sample;
  sample.morphs = {{1, 1, 1}, {1, 1, 1}};
  sampleFit(Still(arm.skeleton.restPosture()), arm.figure(), 1, sample);
  EXPECT_THAT(sample.morphs.weights, ElementsAre(0, 0.25, 0));
  EXPECT_THAT(sample.morphs.rates, ElementsAre(0, 0, 0));
}

TEST(MorphTrack, SaysTheSplineOfItsKeys) {
  const test::Arm arm = faceArm();
  const std::vector<Key> keys{{0, 0}, {1, 1}, {2, 0.5}};
  Diagnostics diagnostics;
  const BoundClip clip = bindMotion(grin(keys), arm.figure(), {}, "/m", diagnostics);
  diagnostics.throwIfErrors();
  const ClipSource source(arm.skeleton, arm.morphs, clip);
  const KeySpline spline(keys, 0);
  PostureSample sample;
  for (const double time_s : {0.0, 0.4, 1.0, 1.7}) {
    source.sample(time_s, sample);
    EXPECT_EQ(sample.morphs.weights[0], spline.at(time_s).value);
    EXPECT_EQ(sample.morphs.rates[0], spline.at(time_s).rate);
    EXPECT_EQ(sample.morphs.weights[1], 0.25);
  }
}

TEST(MorphTrack, OfAMorphThatThereIsNotIsOneFault) {
  const test::Arm arm = faceArm();
  Diagnostics diagnostics;
  bindMotion(grin({{0, 0}}, "smlie"), arm.figure(), {}, "/motions/0", diagnostics);
  ASSERT_EQ(diagnostics.errors().size(), 1u);
  EXPECT_EQ(diagnostics.errors()[0].where.pointer, "/motions/0/tracks/0/morph");
  EXPECT_THAT(diagnostics.errors()[0].message, testing::HasSubstr("smlie"));
  EXPECT_THAT(diagnostics.errors()[0].hint, testing::HasSubstr("smile"));
  Diagnostics none;
  bindMotion(grin({{0, 0}}), test::Arm().figure(), {}, "/m", none);
  ASSERT_EQ(none.errors().size(), 1u);
  EXPECT_THAT(none.errors()[0].hint, testing::HasSubstr("has none"));
}

TEST(MorphTrack, RefusesKeysThatAreNoNumbers) {
  const test::Arm arm = faceArm();
  Diagnostics diagnostics;
  bindMotion(grin({{0, kNan}}), arm.figure(), {}, "/m", diagnostics);
  ASSERT_EQ(diagnostics.errors().size(), 1u);
  EXPECT_EQ(diagnostics.errors()[0].where.pointer, "/m/tracks/0/keys/0/value");
}

TEST(MorphTrack, WarnsOfWeightsThatWillBeClamped) {
  const test::Arm arm = faceArm();
  Diagnostics diagnostics;
  bindMotion(grin({{0, 0}, {1, 12}}), arm.figure(), {}, "/m", diagnostics);
  EXPECT_TRUE(diagnostics.ok());
  EXPECT_EQ(diagnostics.warnings().size(), 1u);
}

// Frames at 10 Hz, as files bring them.
TEST(SampledMotion, PassesThroughItsWeightsWithTheirRates) {
  auto motion = std::make_shared<SampledMotion>();
  motion->name = "talk", motion->rate_hz = 10;
  motion->joints = {"j"};
  motion->morphs = {"blink", "smile"};
  for (int f = 0; f < 11; ++f) {
    motion->rotation.push_back(Eigen::Quaternionf::Identity());
    motion->translation_m.push_back(Eigen::Vector3f::Zero());
    motion->weights.insert(motion->weights.end(), {0.1f * static_cast<float>(f), 0.5f});
  }
  SkeletonDef def;
  def.joints = {{"j",
                 "",
                 Vec3::Zero(),
                 Vec3::Zero(),
                 {{Dof::tx}, {Dof::ty}, {Dof::tz}, {Dof::rx}, {Dof::ry}, {Dof::rz}}}};
  Diagnostics diagnostics;
  const Skeleton skeleton(def, "/s", diagnostics);
  const Flesh flesh;
  const Morphs morphs = faceArm().morphs;
  const SampledFrame frame{"j", "", {}};
  const BoundClip clip =
      bindSampled(motion, {&frame, 1}, {skeleton, flesh, morphs}, "/rig", diagnostics);
  diagnostics.throwIfErrors();
  MorphPose pose;
  for (const double time_s : {0.2, 0.35, 0.8}) {
    sampleMorphs(clip, morphs, time_s, pose);
    EXPECT_NEAR(pose.weights[2], time_s, 1e-6);
    EXPECT_NEAR(pose.rates[2], 1, 1e-4);
    EXPECT_EQ(pose.weights[0], 0.5);
    EXPECT_EQ(pose.weights[1], 0.25);  // rests
  }
  sampleMorphs(clip, morphs, 5, pose);
  EXPECT_NEAR(pose.weights[2], 1, 1e-6);
  EXPECT_EQ(pose.rates[2], 0);
}

}  // namespace
}  // namespace fascia
