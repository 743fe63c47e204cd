#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "rig_checks.h"

namespace fascia {
namespace {

using namespace sample;
using testing::Contains;
using testing::HasSubstr;

TEST(RigMotion, FollowsLinearKeysAtTheirRate) {
  TubeRig rig;
  const float h = std::sqrt(0.5f);
  std::vector<float> times, values;
  for (int k = 0; k <= 30; ++k) {  // 30 keys a second, a quarter turn about x in one second
    const float angle = 3.14159265f / 2 * static_cast<float>(k) / 30;
    times.push_back(2 + static_cast<float>(k) / 30);
    values.insert(values.end(), {std::sin(angle / 2), 0, 0, std::cos(angle / 2)});
  }
  rig.file.animations = "[" + rig.animation("bend", 2, "rotation", times, values) + "]";
  const RiggedModel m = imported(rig);
  expectSound(m);
  ASSERT_EQ(m.motions.size(), 1u);
  const SampledMotion& bend = m.motions[0];
  EXPECT_EQ(bend.name, "bend");
  EXPECT_NEAR(bend.rate_hz, 30, 1e-3);
  EXPECT_EQ(bend.frameCount(), 31u);
  EXPECT_FALSE(bend.loop);
  EXPECT_NEAR(bend.rotation.back().x(), h, 1e-5);
  std::vector<Transform> world;
  poseRig(m, 0, 0.5, world);
  EXPECT_TRUE(world[1].rotation.isApprox(Eigen::AngleAxisd(kPi / 4, Vec3::UnitX()).matrix(), 1e-4));
}

TEST(RigMotion, FollowsStepsAndCubicCurves) {
  TubeRig rig;
  const std::string step =
      rig.animation("step", 2, "translation", {0, 1, 2}, {0, 1, 0, 0, 3, 0, 0, 5, 0}, "STEP");
  // From y = 1 to y = 3 in two seconds, at rest at both ends: y = 1 + 2 (3u² − 2u³).
  const std::string cubic =
      rig.animation("cubic", 2, "translation", {0, 2},
                    {0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0}, "CUBICSPLINE");
  rig.file.animations = "[" + step + "," + cubic + "]";
  const RiggedModel m = imported(rig);
  expectSound(m);
  const SampledMotion &s = m.motions[0], &c = m.motions[1];
  const auto heightAt = [](const SampledMotion& motion, std::size_t f) {
    return motion.translation_m[2 * f + 1].y();
  };
  const auto second = static_cast<std::size_t>(std::lround(s.rate_hz));
  EXPECT_EQ(heightAt(s, second - 1), 1);
  EXPECT_EQ(heightAt(s, second), 3);
  EXPECT_EQ(heightAt(s, 2 * second), 5);
  EXPECT_GE(c.rate_hz, 60);
  for (std::size_t f = 0; f < c.frameCount(); ++f) {
    const double u = static_cast<double>(f) / static_cast<double>(c.frameCount() - 1);
    EXPECT_NEAR(heightAt(c, f), 1 + 2 * (3 * u * u - 2 * u * u * u), 1e-5);
  }
}

TEST(RigMotion, PlaysNodesBetweenAndAboveTheJoints) {
  TubeRig rig;  // the armature, which is no joint, walks along x; its unit is centimetres
  rig.file.nodes =
      R"([{"name":"Armature","children":[1,3],"scale":[0.01,0.01,0.01]},)"
      R"({"name":"lower","children":[4]},{"name":"upper","translation":[0,0.5,0]},)"
      R"({"name":"body","mesh":0,"skin":0},{"name":"between","translation":[0,0.5,0],"children":[2]}])";
  rig.file.animations =
      "[" + rig.animation("walk", 0, "translation", {0, 1}, {0, 0, 0, 2, 0, 0}) + "," +
      rig.animation("lift", 4, "translation", {0, 1}, {0, 0.5f, 0, 0, 1.5f, 0}) + "]";
  const RiggedModel m = imported(rig);
  expectSound(m);
  EXPECT_NEAR(m.height_m(), 0.02, 1e-7);
  std::vector<Transform> world;
  poseRig(m, 0, 1, world);
  EXPECT_TRUE(world[0].translation_m.isApprox(Vec3(2, 0, 0), 1e-6));
  EXPECT_TRUE(world[1].translation_m.isApprox(Vec3(2, 0.01, 0), 1e-6));
  poseRig(m, 1, 1, world);
  EXPECT_TRUE(world[1].translation_m.isApprox(Vec3(0, 0.02, 0), 1e-6));
}

TEST(RigMotion, ClosesLoopsAndDropsTheDoubledFrame) {
  TubeRig rig;
  std::vector<float> times, values;
  for (int k = 0; k <= 24; ++k) {
    const float angle = 0.5f * std::sin(2 * 3.14159265f * static_cast<float>(k) / 24);
    times.push_back(static_cast<float>(k) / 24);
    values.insert(values.end(), {std::sin(angle / 2), 0, 0, std::cos(angle / 2)});
  }
  rig.file.animations = "[" + rig.animation("", 2, "rotation", times, values) + "]";
  const RiggedModel m = imported(rig);
  expectSound(m);
  EXPECT_EQ(m.motions[0].name, "animation 1");
  EXPECT_TRUE(m.motions[0].loop);
  EXPECT_EQ(m.motions[0].frameCount(), 24u);
  EXPECT_NEAR(m.motions[0].duration_s(), 1, 1e-5);
}

TEST(RigMotion, LeavesOutChannelsThatMakeNoSense) {
  TubeRig rig;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  rig.file.animations =
      "[" + rig.animation("nowhere", 99, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}) + "," +
      rig.animation("nothing", 2, "colour", {0, 1}, {0, 0, 0, 1, 0, 0}) + "," +
      rig.animation("backwards", 2, "translation", {1, 0}, {0, 0, 0, 1, 0, 0}) + "," +
      rig.animation("no number", 2, "translation", {0, 1}, {0, 0, 0, nan, 0, 0}) + "," +
      rig.animation("few", 2, "translation", {0, 1}, {0, 0, 0}) + "]";
  const RiggedModel m = imported(rig);
  expectSound(m);
  EXPECT_EQ(m.motions.size(), 5u);
  for (const SampledMotion& motion : m.motions) EXPECT_EQ(motion.frameCount(), 1u);
  EXPECT_THAT(m.notes, Contains(HasSubstr("2 animation channels move nothing that is there")));
  EXPECT_THAT(m.notes, Contains(HasSubstr("3 animation channels have keys that make no sense")));
}

TEST(RigMotion, NotesScaleThatChanges) {
  TubeRig rig;
  rig.file.animations = "[" + rig.animation("grow", 2, "scale", {0, 1}, {1, 1, 1, 2, 1, 1}) + "," +
                        rig.animation("vanish", 2, "scale", {0, 1}, {1, 1, 1, 0, 0, 0}) + "]";
  const RiggedModel m = imported(rig);
  expectSound(m);
  EXPECT_THAT(m.notes, Contains(HasSubstr("1 joints change their size in \"grow\"")));
}

// What counts are the nodes that are moved: a long chain above the joints makes the limit low.
TEST(RigMotion, LongMotionsAreKeptCoarser) {
  TubeRig rig;
  constexpr int kChain = 2000;
  rig.file.nodes = R"([{"children":[3,4]},{"name":"lower","children":[2]},)"
                   R"({"name":"upper","translation":[0,1,0]},{"mesh":0,"skin":0})";
  for (int n = 4; n < 4 + kChain; ++n) {
    const int child = n + 1 < 4 + kChain ? n + 1 : 1;
    rig.file.nodes += R"(,{"children":[)" + std::to_string(child) + "]}";
  }
  rig.file.nodes += "]";
  rig.file.animations =
      "[" + rig.animation("long", 2, "translation", {0, 100}, {0, 1, 0, 1, 1, 0}) + "," +
      rig.animation("eternity", 2, "translation", {0, 1e11f}, {0, 0, 0, 1, 0, 0}) + "]";
  const RiggedModel m = imported(rig);
  ASSERT_EQ(m.motions.size(), 1u);
  EXPECT_GT(m.motions[0].rate_hz, 20);
  EXPECT_LT(m.motions[0].rate_hz, 26);  // 5 million over 2000 nodes over 100 seconds
  EXPECT_NEAR(m.motions[0].duration_s(), 100, 1e-3);
  EXPECT_THAT(m.notes, Contains(HasSubstr("the motions are long")));
  EXPECT_THAT(m.notes, Contains(HasSubstr("'eternity' is too long")));
}

}  // namespace
}  // namespace fascia
