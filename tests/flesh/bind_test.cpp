#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "arm.h"

namespace fascia {
namespace {

using test::Arm;
using testing::ElementsAre;
using testing::IsEmpty;

Key key(double time_s, double value) {
  return {time_s, value, 0, 0, 0};
}

MotionDef flex() {
  MotionDef motion;
  motion.name = "flex";
  motion.duration_s = 2;
  motion.loop = true;
  motion.tracks = {{TrackDef::Target::joint, "elbow", "rz", {key(0, 0), key(1, 2), key(2, 0)}},
                   {TrackDef::Target::solid, "bone", "radius_m", {key(0, 0.03), key(0.7, 0.04)}}};
  return motion;
}

struct Binding {
  Arm arm;
  Diagnostics diagnostics;
  BoundClip clip;

  explicit Binding(const MotionDef& motion) {
    FleshDef ornamentDef;
    ornamentDef.solids = {test::solid("ring", "hand", test::shape("sphere", {}))};
    const Flesh ornaments(ornamentDef, arm.skeleton, "/ornaments", diagnostics,
                          Flesh::Role::ornament);
    clip = bindMotion(motion, arm.figure(), ornaments, "/motions/0", diagnostics);
  }
  std::vector<std::string> errorPointers() const {
    std::vector<std::string> found;
    for (const Issue& issue : diagnostics.errors()) found.push_back(issue.where.pointer);
    return found;
  }
};

TEST(BindMotion, PlaysTheKeysOfItsTracks) {
  const Binding binding(flex());
  ASSERT_THAT(binding.errorPointers(), IsEmpty());
  Posture posture;
  samplePosture(binding.clip, binding.arm.skeleton, 1, posture);
  EXPECT_THAT(posture.values, ElementsAre(0, 0, 0, 2, 0));
  samplePosture(binding.clip, binding.arm.skeleton, 1.5, posture);
  const SplineSample sample = binding.clip.joints[0].spline.at(1.5);
  EXPECT_EQ(posture.values[3], sample.value);
  EXPECT_EQ(posture.rates[3], sample.rate);
  EXPECT_LT(sample.rate, -1);
  EXPECT_EQ(binding.clip.duration_s, 2);
  EXPECT_TRUE(binding.clip.loop);
}

TEST(BindMotion, PlaysTheKeysOfSolidParameters) {
  const Binding binding(flex());
  std::vector<Flesh::ParameterOverride> overrides(7);
  sampleParameters(binding.clip, 0.7, overrides);
  ASSERT_EQ(overrides.size(), 1u);
  EXPECT_EQ(overrides[0].solid, binding.arm.id("bone"));
  EXPECT_EQ(overrides[0].parameter, 0);
  EXPECT_NEAR(overrides[0].value, 0.04, 1e-12);
}

TEST(BindMotion, ClampsPosturesToTheLimits) {
  MotionDef motion = flex();
  motion.tracks[0].keys[1].value = 9;  // the elbow bends to 2.5
  const Binding binding(motion);
  ASSERT_TRUE(binding.diagnostics.ok());
  ASSERT_EQ(binding.diagnostics.warnings().size(), 1u);
  EXPECT_EQ(binding.diagnostics.warnings()[0].where.pointer, "/motions/0/tracks/0/keys/1");
  Posture posture;
  samplePosture(binding.clip, binding.arm.skeleton, 0.9, posture);
  EXPECT_EQ(posture.values[3], 2.5);
  EXPECT_EQ(posture.rates[3], 0);
}

TEST(BindMotion, WarnsOnceOfATrackThatIsClamped) {
  MotionDef motion = flex();
  motion.tracks[0].keys = {key(0, 9), key(0.5, 0), key(1, -9)};
  const Binding binding(motion);
  ASSERT_EQ(binding.diagnostics.warnings().size(), 1u);
  EXPECT_EQ(binding.diagnostics.warnings()[0].where.pointer, "/motions/0/tracks/0/keys/0");
  EXPECT_THAT(binding.diagnostics.warnings()[0].message,
              testing::EndsWith("will be clamped, as are 1 more of the track"));
}

TEST(BindMotion, RefusesWhatIsNotThereAllAtOnce) {
  MotionDef motion = flex();
  motion.tracks.push_back({TrackDef::Target::joint, "elbo", "rz", {key(0, 0)}});
  motion.tracks.push_back({TrackDef::Target::joint, "elbow", "rw", {key(0, 0)}});
  motion.tracks.push_back({TrackDef::Target::joint, "elbow", "tx", {key(0, 0)}});
  motion.tracks.push_back({TrackDef::Target::solid, "bicep", "half_x_m", {key(0, 0.1)}});
  motion.tracks.push_back({TrackDef::Target::solid, "biceps", "half_q_m", {key(0, 0.1)}});
  motion.tracks.push_back({TrackDef::Target::solid, "ring", "radius_m", {key(0, 0.1)}});
  const Binding binding(motion);
  ASSERT_THAT(binding.errorPointers(),
              ElementsAre("/motions/0/tracks/2/joint", "/motions/0/tracks/3/dof",
                          "/motions/0/tracks/4/dof", "/motions/0/tracks/5/solid",
                          "/motions/0/tracks/6/parameter", "/motions/0/tracks/7/solid"));
  EXPECT_EQ(binding.diagnostics.errors()[0].hint, "did you mean 'elbow'?");
  EXPECT_EQ(binding.diagnostics.errors()[3].hint, "did you mean 'biceps'?");
}

TEST(BindMotion, ReportsTheMotionsOwnFaultsToo) {
  MotionDef motion = flex();
  motion.tracks[0].keys[1].time_s = -1;
  motion.tracks[1].name = "nothing";
  const Binding binding(motion);
  EXPECT_THAT(binding.errorPointers(),
              ElementsAre("/motions/0/tracks/0/keys/1/t_s", "/motions/0/tracks/0/keys/1",
                          "/motions/0/tracks/1/solid"));
}

}  // namespace
}  // namespace fascia
