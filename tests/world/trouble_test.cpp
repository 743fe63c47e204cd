#include <algorithm>

#include <gtest/gtest.h>

#include <fascia/world/stage_recording.h>
#include <fascia/world/trouble.h>

#include "scenes.h"

namespace fascia {
namespace {

using Kind = BodyTrouble::Kind;

SceneBodyDef jelly(const std::string& name, const Vec3& position_m, double radius_m) {
  SceneBodyDef body = test::ball(name, position_m, radius_m);
  body.basis.kind = BodyBasisDef::Kind::polynomial, body.basis.order = 2;
  body.density_kg_per_m3 = 300;
  body.rigidity_Pa = 3000, body.volume_Pa = 8000, body.relaxation_s = 0.008;
  body.points.push_back({"foot", Vec3(0, -radius_m, 0)});
  return body;
}

double heightOf(Performance& performance, const std::string& name) {
  Puppet& puppet = performance.puppet();
  return puppet.distance_m(puppet.find(name + ".top"), puppet.find(name + ".foot"));
}

TEST(BodyTrouble, WhoStartsInTheGroundIsNamedAndComesOut) {
  SceneDef def;
  def.ground = GroundDef{};
  def.bodies = {jelly("sunk", Vec3(0, 0.05, 0), 0.2), jelly("well", Vec3(2, 0.21, 0), 0.2)};
  const Stage stage(def);
  Performance performance(stage);
  ASSERT_EQ(performance.troubles().size(), 1u);
  EXPECT_EQ(performance.troubles()[0].kind, Kind::sunk);
  EXPECT_NEAR(performance.troubles()[0].worst, 0.15, 1e-3);
  EXPECT_TRUE(performance.troubles()[0].lasts);
  test::run(performance, 2);
  ASSERT_EQ(performance.troubles().size(), 1u);
  EXPECT_FALSE(performance.troubles()[0].lasts);
  EXPECT_LT(performance.troubles()[0].to_s, 1);
  EXPECT_TRUE(anyFault(performance.troubles()));
  EXPECT_TRUE(textOf(stage, performance.troubles()[0]).starts_with("sunk was 0.15 m below"));
}

TEST(BodyTrouble, BodiesThatStartInsideOfEachOtherAreNamedAndPart) {
  SceneDef def;
  def.ground = GroundDef{};
  def.bodies = {jelly("a", Vec3(0, 0.31, 0), 0.3), jelly("b", Vec3(0.35, 0.31, 0.02), 0.3)};
  const Stage stage(def);
  Performance performance(stage);
  ASSERT_FALSE(performance.troubles().empty());
  EXPECT_EQ(performance.troubles()[0].kind, Kind::inside);
  EXPECT_EQ(performance.troubles()[0].with, "b");
  test::run(performance, 3);
  for (const BodyTrouble& trouble : performance.troubles())
    EXPECT_FALSE(trouble.lasts) << textOf(stage, trouble);
  EXPECT_NEAR(heightOf(performance, "a"), 0.6, 0.06);
  EXPECT_NEAR(heightOf(performance, "b"), 0.6, 0.06);
}

// A jelly that is led into the middle of another one in no time.
TEST(BodyTrouble, AChaseLetsGoRatherThanCrush) {
  SceneDef def;
  def.ground = GroundDef{};
  def.bodies = {jelly("big", Vec3(-1, 0.36, 0), 0.35), jelly("small", Vec3(1, 0.26, 0), 0.25)};
  def.script = "crush.lua";
  def.script_text = "wait(0.3) log(chase(\"small\", \"big.top\", 0.6)) wait(2) succeed()";
  def.simulation.duration_s = 4;
  const Stage stage(def);
  const StageRecording recording = record(stage, {});
  for (const BodyTrouble& trouble : recording.troubles)
    EXPECT_FALSE(trouble.lasts) << textOf(stage, trouble);
  Performance performance(stage);
  test::run(performance, 4);
  EXPECT_NEAR(heightOf(performance, "big"), 0.7, 0.07);
  EXPECT_NEAR(heightOf(performance, "small"), 0.5, 0.05);
}

TEST(BodyTrouble, NoneIsFoundInBodiesThatLieAndRoll) {
  SceneDef def;
  def.ground = GroundDef{};
  for (int i = 0; i < 4; ++i)
    def.bodies.push_back(jelly("b" + std::to_string(i), Vec3(0.05 * i, 0.21 + 0.42 * i, 0), 0.2));
  const Stage stage(def);
  Performance performance(stage);
  test::run(performance, 3);
  for (const BodyTrouble& trouble : performance.troubles()) ADD_FAILURE() << textOf(stage, trouble);
}

}  // namespace
}  // namespace fascia
