#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes.h"

namespace fascia {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

SceneDef twoBalls() {
  SceneDef def;
  def.bodies = {test::ball("a", Vec3(0, 1, 0)), test::ball("b", Vec3(1, 1, 0))};
  def.places = {{"hook", Vec3(0, 2, 0)}};
  return def;
}

TEST(Stage, KnowsPointsByBodyAndNameAndPlaces) {
  const Stage stage(twoBalls());
  ASSERT_TRUE(stage.findPoint("a"));
  EXPECT_EQ(stage.findPoint("b.top")->body, BodyId(1));
  EXPECT_EQ(stage.findPoint("b.top")->X_m, Vec3(0, 0.2, 0));
  EXPECT_EQ(*stage.findPlace("hook"), Vec3(0, 2, 0));
  EXPECT_FALSE(stage.findPoint("hook"));
  EXPECT_FALSE(stage.findPlace("a"));
}

TEST(Stage, BodiesHaveTheMassOfTheirSolidsAndStartWhereTheyArePut) {
  SceneDef def = twoBalls();
  def.bodies[1].velocity_m_per_s = Vec3(1, 2, 3);
  def.bodies[1].density_kg_per_m3 = 500;
  const Stage stage(def);
  const OdeState start = stage.startState(0);
  EXPECT_NEAR(stage.bodies().shape(BodyId(1)).mass_kg(), 500 * 4.0 / 3 * kPi * 0.008, 0.3);
  EXPECT_NEAR((stage.bodies().point(start.r, {BodyId(1), Vec3::Zero()}) - Vec3(1, 1, 0)).norm(), 0,
              1e-9);
  EXPECT_NEAR((stage.bodies().momentum_Ns(start.v) / stage.bodies().shape(BodyId(1)).mass_kg() -
               Vec3(1, 2, 3))
                  .norm(),
              0, 1e-9);
}

TEST(Stage, SeedsScatterWithinWhatTheFileAllowsAndZeroDoesNot) {
  SceneDef def = twoBalls();
  def.bodies[0].scatter.position_m = Vec3(0.3, 0, 0.1);
  const Stage stage(def);
  const auto centerOf = [&](std::uint64_t seed) {
    return stage.bodies().point(stage.startState(seed).r, {BodyId(0), Vec3::Zero()});
  };
  EXPECT_NEAR((centerOf(0) - Vec3(0, 1, 0)).norm(), 0, 1e-12);
  double least = 1, most = -1;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Vec3 center = centerOf(seed);
    EXPECT_EQ(center, centerOf(seed));
    EXPECT_LE(std::abs(center.x()), 0.3 + 1e-12);
    EXPECT_NEAR(center.y(), 1, 1e-12);
    EXPECT_LE(std::abs(center.z()), 0.1 + 1e-12);
    least = std::min(least, center.x()), most = std::max(most, center.x());
  }
  EXPECT_LT(least, -0.25);
  EXPECT_GT(most, 0.25);
}

TEST(Stage, FaultsNameTheirPlaces) {
  SceneDef def = twoBalls();
  def.constraints.push_back({"", SceneConstraintDef::Kind::attach, {"a.tpo", "b"}});
  def.constraints.push_back({"", SceneConstraintDef::Kind::nail, {"hook"}});
  def.constraints.push_back({"", SceneConstraintDef::Kind::rod, {"a"}});
  def.constraints.push_back({"", SceneConstraintDef::Kind::line, {"a"}, Vec3::Zero()});
  def.paths.push_back({"a.top", {{1, Vec3::Zero(), {}, {}}, {1, Vec3::Zero(), {}, {}}}});
  EXPECT_THAT(test::faultsOf(def),
              ElementsAre("/constraints/0/points/0: no point is named 'a.tpo'",
                          "/constraints/1/points/0: 'hook' is a place, expected a body's point",
                          "/constraints/2/points: found 1 points, expected 2",
                          "/constraints/3/direction: found no direction, expected any length but 0",
                          "/paths/0/keys/1/time_s: found 1 after 1"));
}

TEST(Stage, RefusesNamesThatWouldMeanTwoThings) {
  SceneDef def = twoBalls();
  def.bodies[1].name = "a";
  EXPECT_THAT(test::faultsOf(def), ElementsAre("/bodies/1/name: found 'a' a second time"));
  def = twoBalls();
  def.bodies[1].name = "a.top";
  def.places[0].name = "a";
  EXPECT_THAT(test::faultsOf(def), UnorderedElementsAre(HasSubstr("/bodies/1/name: found 'a.top'"),
                                                        "/places/0/name: 'a' is a body already"));
}

TEST(Stage, RefusesBodiesOfTheOtherDimension) {
  SceneDef def = twoBalls();
  def.bodies[1] = test::plate("b", Vec3::Zero());
  EXPECT_THAT(test::faultsOf(def),
              ElementsAre(HasSubstr("/bodies/1: an outline is a body in two")));
  def.dimension = 2;
  EXPECT_THAT(test::faultsOf(def), ElementsAre(HasSubstr("/bodies/0: found a solid")));
}

TEST(Stage, RefusesOutlinesThatCrossThemselvesAndShapesOutOfRange) {
  SceneDef def;
  def.dimension = 2;
  def.bodies = {test::plate("a", Vec3::Zero())};
  std::swap(def.bodies[0].outline_m[1], def.bodies[0].outline_m[2]);
  EXPECT_THAT(test::faultsOf(def), ElementsAre(HasSubstr("/bodies/0")));
  def = twoBalls();
  def.props.emplace_back().name = "stone";
  def.props[0].solid.parameters = {-1};
  EXPECT_THAT(test::faultsOf(def), ElementsAre(HasSubstr("/props/0/radius_m")));
}

TEST(Stage, RefusesContactForSchemesWithoutIt) {
  SceneDef def = twoBalls();
  def.simulation.scheme = "energy";
  EXPECT_THAT(test::faultsOf(def), IsEmpty());
  def.ground = GroundDef{};
  EXPECT_THAT(test::faultsOf(def), ElementsAre(HasSubstr("/simulation/scheme")));
}

TEST(Stage, RefusesMoreCoordinatesThanItCouldSimulate) {
  SceneDef def;
  SceneBodyDef body = test::ball("a", Vec3::Zero());
  body.basis = {BodyBasisDef::Kind::polynomial, 8, Eigen::Vector3i::Ones()};
  body.solid.shape = "sphere";
  for (int i = 0; i < 250; ++i) {
    body.name = "b" + std::to_string(i);
    def.bodies.push_back(body);
  }
  const std::vector<std::string> faults = test::faultsOf(def);
  ASSERT_FALSE(faults.empty());
  EXPECT_THAT(faults.front(), HasSubstr("too many coordinates"));
}

TEST(Stage, FramesAreWholeNumbersOfSteps) {
  SceneDef def = twoBalls();
  def.simulation.step_s = 1.0 / 100;
  const Stage stage(def);
  EXPECT_EQ(stage.stepsPerFrame(60), 2u);
  EXPECT_EQ(stage.stepsPerFrame(100), 1u);
  EXPECT_EQ(stage.stepsPerFrame(25), 4u);
}

}  // namespace
}  // namespace fascia
