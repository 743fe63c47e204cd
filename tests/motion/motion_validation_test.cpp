#include <limits>
#include <string>

#include <fascia/motion/motion.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "keys.h"

namespace fascia {
namespace {

using test::key;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

MotionDef goodMotion() {
  MotionDef motion;
  motion.name = "wave";
  motion.duration_s = 2;
  motion.loop = true;
  motion.tracks.push_back(
      {TrackDef::Target::joint, "elbow", "rx", {key(0, 0), key(1, 1), key(2, 0)}});
  motion.tracks.push_back({TrackDef::Target::solid, "biceps", "ax_m", {key(0, 1), key(1, 2)}});
  return motion;
}

std::vector<std::string> errorPointers(const MotionDef& motion) {
  Diagnostics diagnostics;
  validateMotion(motion, "/motions/3", diagnostics);
  std::vector<std::string> pointers;
  for (const Issue& issue : diagnostics.errors()) pointers.push_back(issue.where.pointer);
  return pointers;
}

TEST(MotionValidation, AcceptsAGoodMotion) {
  EXPECT_THAT(errorPointers(goodMotion()), IsEmpty());
}

TEST(MotionValidation, RefusesNumbersThatAreNotFiniteOrAbsurd) {
  for (double bad : {kNaN, kInfinity, -kInfinity, 2e6}) {
    const std::pair<double Key::*, std::string> kNumbers[] = {{&Key::time_s, "t_s"},
                                                              {&Key::value, "value"},
                                                              {&Key::tension, "tension"},
                                                              {&Key::continuity, "continuity"},
                                                              {&Key::bias, "bias"}};
    for (const auto& [number, key] : kNumbers) {
      MotionDef motion = goodMotion();
      motion.tracks[1].keys[1].*number = bad;
      EXPECT_THAT(errorPointers(motion), testing::Contains("/motions/3/tracks/1/keys/1/" + key));
    }
    MotionDef motion = goodMotion();
    motion.duration_s = bad;
    EXPECT_THAT(errorPointers(motion), ElementsAre("/motions/3/duration_s"));
  }
}

TEST(MotionValidation, RefusesKeysAtTheSameTimeOrOutOfOrder) {
  MotionDef motion = goodMotion();
  motion.tracks[0].keys[1].time_s = 0;
  motion.tracks[1].keys = {key(1, 0), key(0.5, 1)};
  EXPECT_THAT(errorPointers(motion),
              ElementsAre("/motions/3/tracks/0/keys/1", "/motions/3/tracks/1/keys/1"));
}

TEST(MotionValidation, RefusesATensionOutsideItsRange) {
  MotionDef motion = goodMotion();
  motion.tracks[0].keys[2].tension = 1.01;
  EXPECT_THAT(errorPointers(motion), ElementsAre("/motions/3/tracks/0/keys/2/tension"));
}

TEST(MotionValidation, RefusesALoopThatJumps) {
  MotionDef motion = goodMotion();
  motion.tracks[0].keys[2].value = 0.1;
  EXPECT_THAT(errorPointers(motion), ElementsAre("/motions/3/tracks/0/keys/2"));
  motion.loop = false;
  EXPECT_THAT(errorPointers(motion), IsEmpty());
}

TEST(MotionValidation, RefusesKeysBeyondALoop) {
  MotionDef motion = goodMotion();
  motion.tracks[1].keys[1].time_s = 2.5;
  EXPECT_THAT(errorPointers(motion), ElementsAre("/motions/3/tracks/1/keys/1"));
}

TEST(MotionValidation, RefusesALoopWithoutDuration) {
  MotionDef motion = goodMotion();
  motion.duration_s = 0;
  motion.tracks[0].keys = {key(0, 1)};
  motion.tracks[1].keys = {key(0, 1)};
  EXPECT_THAT(errorPointers(motion), ElementsAre("/motions/3/duration_s"));
}

TEST(MotionValidation, RefusesMissingNamesAndKeysAllAtOnce) {
  MotionDef motion = goodMotion();
  motion.name.clear();
  motion.tracks[0].name.clear();
  motion.tracks[0].channel.clear();
  motion.tracks[1].name.clear();
  motion.tracks[1].channel.clear();
  motion.tracks[1].keys.clear();
  EXPECT_THAT(errorPointers(motion),
              ElementsAre("/motions/3/name", "/motions/3/tracks/0/joint", "/motions/3/tracks/0/dof",
                          "/motions/3/tracks/1/solid", "/motions/3/tracks/1/parameter",
                          "/motions/3/tracks/1/keys"));
}

TEST(MotionValidation, RefusesTwoTracksForOneNumber) {
  MotionDef motion = goodMotion();
  motion.tracks.push_back(motion.tracks[0]);
  EXPECT_THAT(errorPointers(motion), ElementsAre("/motions/3/tracks/2"));
}

TEST(MotionValidation, RefusesMoreTracksThanAFigureHasNumbers) {
  MotionDef motion = goodMotion();
  motion.tracks.resize(kMostTracks + 1);
  EXPECT_THAT(errorPointers(motion), ElementsAre("/motions/3/tracks"));
}

TEST(MotionValidation, WarnsOfKeysThatAreNeverReached) {
  MotionDef motion = goodMotion();
  motion.loop = false;
  motion.duration_s = 1.5;
  Diagnostics diagnostics;
  validateMotion(motion, "/m", diagnostics);
  EXPECT_TRUE(diagnostics.ok());
  ASSERT_EQ(diagnostics.warnings().size(), 1u);
  EXPECT_EQ(diagnostics.warnings()[0].where.pointer, "/m/tracks/0/keys/2");
}

TEST(MotionValidation, SaysWhatWasFoundAndExpected) {
  MotionDef motion = goodMotion();
  motion.tracks[0].keys[1].tension = 3;
  Diagnostics diagnostics;
  validateMotion(motion, "/m", diagnostics);
  ASSERT_EQ(diagnostics.errors().size(), 1u);
  EXPECT_THAT(diagnostics.errors()[0].text(),
              HasSubstr("tension: found 3, expected a number in [-1, 1]"));
}

TEST(PlayedDuration, IsTheLastKeyUnlessGiven) {
  MotionDef motion = goodMotion();
  motion.tracks[0].keys.back().time_s = 1.75;
  EXPECT_EQ(playedDuration_s(motion), 2);
  motion.duration_s = 0;
  EXPECT_EQ(playedDuration_s(motion), 1.75);
}

}  // namespace
}  // namespace fascia
