#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "arm.h"

namespace fascia {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<Issue> errors(const FleshDef& def, Flesh::Role role = Flesh::Role::muscle) {
  Diagnostics diagnostics;
  const Skeleton skeleton(test::armSkeleton(), "/skeleton", diagnostics);
  const Flesh flesh(def, skeleton, "/solids", diagnostics, role);
  return diagnostics.errors();
}

std::vector<std::string> pointers(const std::vector<Issue>& issues) {
  std::vector<std::string> found;
  for (const Issue& issue : issues) found.push_back(issue.where.pointer);
  return found;
}

TEST(FleshValidation, AcceptsTheArm) {
  EXPECT_THAT(pointers(errors(test::armFlesh())), IsEmpty());
}

TEST(FleshValidation, RefusesMissingAndDuplicateNames) {
  FleshDef def = test::armFlesh();
  def.solids[0].name = "";
  def.solids[3].name = "biceps";
  EXPECT_THAT(pointers(errors(def)), ElementsAre("/solids/0/name", "/solids/3/name"));
}

TEST(FleshValidation, UnknownJointGetsTheNearestName) {
  FleshDef def = test::armFlesh();
  def.solids[2].joint = "elbo";
  const std::vector<Issue> found = errors(def);
  ASSERT_THAT(pointers(found), ElementsAre("/solids/2/joint"));
  EXPECT_EQ(found[0].hint, "did you mean 'elbow'?");
}

TEST(FleshValidation, RefusesPlacesThatAreNotFiniteOrAbsurd) {
  for (double bad : {kNaN, kInfinity, -2e6}) {
    FleshDef def = test::armFlesh();
    def.solids[1].position_m.z() = bad;
    def.solids[2].orientation_rad.x() = bad;
    EXPECT_THAT(pointers(errors(def)),
                ElementsAre("/solids/1/position_m/2", "/solids/2/orientation_deg/0"));
  }
}

TEST(FleshValidation, RefusesUnknownShapesAndTooManySolids) {
  FleshDef def = test::armFlesh();
  def.solids[0].solid.shape = "sphear";
  EXPECT_THAT(pointers(errors(def)), ElementsAre("/solids/0/shape"));
  def.solids.assign(5000, test::armFlesh().solids[0]);
  EXPECT_THAT(pointers(errors(def)), ElementsAre("/solids"));
}

TEST(FleshValidation, RefusesDriversOfWhatIsNotThere) {
  FleshDef def = test::armFlesh();
  def.solids[1].drivers[0].parameter = "half_w_m";
  def.solids[2].drivers[0].joint = "knee";
  def.solids[3].drivers[0].dof = Dof::tx;
  const std::vector<Issue> found = errors(def);
  ASSERT_THAT(pointers(found), ElementsAre("/solids/1/drivers/0/parameter",
                                           "/solids/2/drivers/0/joint", "/solids/3/drivers/0/dof"));
  EXPECT_THAT(found[0].hint, HasSubstr("half_"));
  EXPECT_THAT(found[2].hint, HasSubstr("rz"));
}

TEST(FleshValidation, RefusesTwoDriversOfOneParameter) {
  FleshDef def = test::armFlesh();
  def.solids[1].drivers[1].parameter = def.solids[1].drivers[0].parameter;
  EXPECT_THAT(pointers(errors(def)), ElementsAre("/solids/1/drivers/1/parameter"));
}

TEST(FleshValidation, RefusesBadDriverPoints) {
  const auto withPoints = [](std::vector<DriverDef::Point> points) {
    FleshDef def = test::armFlesh();
    def.solids[1].drivers[0].points = std::move(points);
    return pointers(errors(def));
  };
  EXPECT_THAT(withPoints({}), ElementsAre("/solids/1/drivers/0/points"));
  EXPECT_THAT(withPoints({{0, 0.1}}), ElementsAre("/solids/1/drivers/0/points"));
  EXPECT_THAT(withPoints({{1, 0.1}, {1, 0.2}}), ElementsAre("/solids/1/drivers/0/points/1"));
  EXPECT_THAT(withPoints({{1, 0.1}, {0, 0.2}}), ElementsAre("/solids/1/drivers/0/points/1"));
  EXPECT_THAT(withPoints({{0, -1}, {1, 0.2}}), ElementsAre("/solids/1/drivers/0/points/0"));
  EXPECT_THAT(withPoints({{0, kNaN}, {1, 0.2}}), ElementsAre("/solids/1/drivers/0/points/0/1"));
  EXPECT_THAT(withPoints({{0, 0.1}, {kInfinity, 0.2}}),
              ElementsAre("/solids/1/drivers/0/points/1/0"));
}

TEST(FleshValidation, BrokenSkeletonIsReportedOnceNotForEverySolid) {
  SkeletonDef broken = test::armSkeleton();
  broken.joints[1].parent = "nobody";
  Diagnostics diagnostics;
  const Skeleton skeleton(broken, "/skeleton", diagnostics);
  const Flesh flesh(test::armFlesh(), skeleton, "/solids", diagnostics);
  EXPECT_THAT(pointers(diagnostics.errors()), ElementsAre("/skeleton/1/parent"));
}

TEST(FleshValidation, RefusesDriversOnOrnaments) {
  FleshDef def = test::armFlesh();
  def.solids.resize(2);
  EXPECT_THAT(pointers(errors(def, Flesh::Role::ornament)), ElementsAre("/solids/1/drivers"));
}

}  // namespace
}  // namespace fascia
