// Bodies in hats and jackets: what is worn must not empty what is below.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fascia/fitting/fit_flesh.h>

#include "fitting/rigs.h"

namespace fascia {
namespace {

using namespace testing;
using ::testing::Contains;
using ::testing::HasSubstr;

// A trunk and a head of their own pieces.
RiggedModel trunkAndHead() {
  RiggedModel model;
  addJoint(model, "chest", -1, Vec3(0, 1, 0));
  addJoint(model, "head", 0, Vec3(0, 1.5, 0));
  addEllipsoid(model, Vec3(0, 1.2, 0), Vec3(0.15, 0.28, 0.12),
               [](const Vec3&) { return onlyJoint(0); });
  addEllipsoid(model, Vec3(0, 1.68, 0), Vec3(0.13, 0.18, 0.14),
               [](const Vec3&) { return onlyJoint(1); });
  return model;
}

// A closed surface of revolution about y through points of (radius, height), from pole to pole.
void addTurned(RiggedModel& model, const std::vector<Eigen::Vector2d>& profile, std::size_t joint) {
  addClosedSurface(
      model, 40, static_cast<int>(profile.size()) - 1,
      [&](double u, double v) {
        const auto k =
            static_cast<std::size_t>(std::lround(v * static_cast<double>(profile.size() - 1)));
        const double a = 2 * kPi * u;
        return Vec3(profile[k].x() * std::cos(a), profile[k].y(), -profile[k].x() * std::sin(a));
      },
      [=](const Vec3&) { return onlyJoint(joint); });
}

const JointFit& named(const FleshFit& fit, const std::string& joint) {
  for (const JointFit& one : fit.joints)
    if (one.joint == joint) return one;
  throw std::runtime_error("no joint " + joint);
}

TEST(WornPieces, AHatLeavesTheHeadItsFlesh) {
  RiggedModel model = trunkAndHead();
  addTurned(model, {{0, 1.80}, {0.2, 1.80}, {0.5, 1.80}, {0.5, 1.82}, {0.2, 1.82}, {0, 1.82}}, 1);
  addTurned(model, {{0, 1.82}, {0.12, 1.82}, {0.2, 1.83}, {0.15, 2}, {0.08, 2.2}, {0, 2.4}}, 1);
  const FleshFit bare = fitFlesh(trunkAndHead()), hat = fitFlesh(model);
  EXPECT_GT(named(bare, "head").coverage, 0.95);
  EXPECT_GT(named(hat, "head").coverage, 0.9);
  EXPECT_LT(named(hat, "head").residual_rms_m, 2 * named(bare, "head").residual_rms_m);
  EXPECT_EQ(hat.deepest_outside_m, 0);
  EXPECT_THAT(hat.notes, Contains(HasSubstr("worn over the flesh")));
}

TEST(WornPieces, AJacketLeavesTheChestItsFlesh) {
  RiggedModel model = trunkAndHead();
  std::vector<Eigen::Vector2d> wall;  // up outside, down inside: closed, a centimetre thick
  for (int k = 0; k <= 10; ++k) wall.emplace_back(0.19, 1 + 0.04 * k);
  for (int k = 10; k >= 0; --k) wall.emplace_back(0.18, 1 + 0.04 * k);
  addClosedSurface(
      model, 40, 21,
      [&](double u, double v) {
        const auto k = static_cast<std::size_t>(std::lround(v * 21));
        const double a = 2 * kPi * u;
        return Vec3(wall[k].x() * std::cos(a), wall[k].y(), -wall[k].x() * std::sin(a));
      },
      [](const Vec3&) { return onlyJoint(0); });
  const FleshFit bare = fitFlesh(trunkAndHead()), dressed = fitFlesh(model);
  EXPECT_GT(named(dressed, "chest").coverage, 0.95);
  EXPECT_LT(named(dressed, "chest").residual_rms_m, 2 * named(bare, "chest").residual_rms_m);
  EXPECT_TRUE(named(dressed, "chest").why.empty());
}

TEST(WornPieces, StandingElsewhereChangesNothing) {
  RiggedModel model;
  addJoint(model, "root", -1, Vec3::Zero());
  addJoint(model, "chest", 0, Vec3(0, 1, 0));
  addEllipsoid(model, Vec3(0, 1, 0), Vec3(0.15, 0.25, 0.1),
               [](const Vec3&) { return onlyJoint(1); });
  addArm(model, 1, 1, ".L");
  addArm(model, 1, -1, ".R");
  const FleshFit home = fitFlesh(model);
  for (const Vec3& off : {Vec3(3, 0, 0), Vec3(-40, 1, 7)}) {
    RiggedModel moved = model;  // but for the root, which stays at the origin
    for (std::size_t j = 1; j < moved.joints.size(); ++j)
      moved.joints[j].rest_world.translation_m += off;
    for (Eigen::Vector3f& p : moved.points_m) p += off.cast<float>();
    const FleshFit there = fitFlesh(moved);
    EXPECT_EQ(there.notes, home.notes);
    ASSERT_EQ(there.flesh.solids.size(), home.flesh.solids.size());
    for (std::size_t i = 0; i < home.flesh.solids.size(); ++i)
      EXPECT_EQ(there.flesh.solids[i].name, home.flesh.solids[i].name);
    EXPECT_NEAR(there.coverage, home.coverage, 0.01);
  }
}

}  // namespace
}  // namespace fascia
