#include <gtest/gtest.h>

#include <fascia/base/random.h>
#include <fascia/skin/felt_contact.h>

#include "test_fields.h"

namespace fascia {
namespace {

using test::RigidSolids;

constexpr double kRadius_m = 0.3, kYield_m = 0.02;
// More than one chunk, whose last is neither full nor whole vectors.
constexpr std::size_t kPoints = FleshSense::kChunk + 77;

// Points on the x axis, and a ball of flesh around the origin beside one far away. Point i lies so
// deep in the first ball, and so do its joints carry it.
struct Line {
  RigidSolids field;
  PointModel points;
  VectorArray position, velocity;
  PointSurroundings around;
  FleshSense sense;

  Line() {
    field.addSphere(Vec3::Zero(), kRadius_m).addSphere(Vec3(5, 0, 0), kRadius_m);
    const std::size_t storage = kPoints + FleshSense::kPad;  // padding for whole vectors
    position.resize(storage), velocity.resize(storage), around.resize(storage);
    points.fat.assign(storage, 0.f);
    points.free.assign(storage, 1.f);
    for (std::size_t i = 0; i < storage; ++i)
      position.x[i] = static_cast<float>(kRadius_m - depth(i));
    around.anchor = position;
    letYield(false);
  }
  static double depth(std::size_t i) { return 0.0015 * static_cast<double>(i % 64) + 0.0007; }
  double pushed(std::size_t i) const { return double{position.x[i]} - (kRadius_m - depth(i)); }
  void project(FeltContact& contact) {
    contact.project(field, points, 0.02f, 0.f, position, velocity, around);
  }
  // Points that `feels` says feel the first ball; all feel the second.
  template <class Feels>
  void setFelt(const Feels& feels, bool yields = false) {
    std::vector<FleshSense::Feeling> feelings;
    for (std::uint32_t i = 0; i < kPoints; ++i) {
      if (feels(i)) feelings.push_back({i, SolidId(0), yields});
      feelings.push_back({i, SolidId(1), false});
    }
    sense = FleshSense(feelings, 2, FloatArray(kPoints, static_cast<float>(kYield_m)));
  }
  void letYield(bool yields = true) {
    setFelt([](std::size_t) { return true; }, yields);
  }
};

TEST(FleshSense, PushesOnlyPointsThatFeelTheSolid) {
  Line line;
  line.setFelt([](std::size_t i) { return i % 3 != 1; });
  FeltContact contact(line.sense);
  line.project(contact);
  for (std::size_t i = 0; i < kPoints; ++i) {
    if (i % 3 != 1)
      EXPECT_NEAR(line.pushed(i), Line::depth(i), 1e-5) << i;
    else
      EXPECT_NEAR(line.pushed(i), 0, 1e-7) << i;
  }
}

TEST(FleshSense, LeavesPointsAloneThatFeelNothingNear) {
  Line line;
  constexpr std::size_t kFeeling = 40;
  line.setFelt([](std::size_t i) { return i < kFeeling; });
  FeltContact contact(line.sense);
  line.project(contact);
  EXPECT_NEAR(line.pushed(20), Line::depth(20), 1e-5);
  EXPECT_NEAR(line.around.normal.x[20], 1, 1e-6);
  for (std::size_t i = kFeeling; i < kPoints; ++i) {
    EXPECT_NEAR(line.pushed(i), 0, 1e-7) << i;
    EXPECT_EQ(line.around.normal.x[i], 0) << i;  // no half space either
  }
}

TEST(FleshSense, MeasuresDepthOnlyWhereSolidsAreFelt) {
  Line line;
  constexpr std::size_t kDeepestFelt = 40;
  line.setFelt([](std::size_t i) { return i <= kDeepestFelt; });
  const FeltContact contact(line.sense);
  EXPECT_NEAR(contact.deepest(line.field, line.points, line.position), Line::depth(kDeepestFelt),
              1e-6);
}

TEST(FleshSense, YieldsToFleshAsFarAsTheAnchorLiesInIt) {
  for (const float share : {0.f, 0.5f, 1.f}) {
    Line line;
    line.letYield();
    for (std::size_t i = 0; i < kPoints; ++i)
      line.around.anchor.x[i] = static_cast<float>(kRadius_m - share * Line::depth(i));
    FeltContact contact(line.sense);
    contact.findYielding(line.field, line.points, line.around.anchor);
    // An anchor deeper than its yield makes its point feel nothing.
    const auto left = [&](std::size_t i) {
      return share * Line::depth(i) < kYield_m ? (1 - share) * Line::depth(i) : 0;
    };
    double deepest = 0;
    for (std::size_t i = 0; i < kPoints; ++i) deepest = std::max(deepest, left(i));
    EXPECT_NEAR(contact.deepest(line.field, line.points, line.position), deepest, 1e-6);
    line.project(contact);
    for (std::size_t i = 0; i < kPoints; ++i) EXPECT_NEAR(line.pushed(i), left(i), 1e-5) << i;
    EXPECT_LT(contact.deepest(line.field, line.points, line.position), 1e-5);
  }
}

TEST(FleshSense, KeepsPushingWhereTheAnchorLiesOutside) {
  Line line;
  line.letYield();
  for (float& x : line.around.anchor.x) x = static_cast<float>(kRadius_m) + 0.01f;
  FeltContact contact(line.sense);
  contact.findYielding(line.field, line.points, line.around.anchor);
  line.project(contact);
  for (std::size_t i = 0; i < kPoints; ++i) EXPECT_NEAR(line.pushed(i), Line::depth(i), 1e-5) << i;
}

TEST(FleshSense, NeverYieldsWherePointsAreToldNotTo) {
  Line line;
  FeltContact contact(line.sense);
  contact.findYielding(line.field, line.points, line.around.anchor);
  line.project(contact);
  for (std::size_t i = 0; i < kPoints; ++i) EXPECT_NEAR(line.pushed(i), Line::depth(i), 1e-5) << i;
}

TEST(FleshSense, LetsAnchorsYieldGentlyUpToThreeTimesTheYield) {
  Line line;
  line.letYield();
  FeltContact contact(line.sense);
  contact.projectAnchors(line.field, line.points, line.position);
  std::size_t between = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double depth = Line::depth(i);
    const double push = depth <= kYield_m ? depth : kYield_m - 0.5 * (depth - kYield_m);
    if (depth > kYield_m && push > 0) ++between;
    EXPECT_NEAR(line.pushed(i), std::max(0.0, push), 1e-5) << depth;
  }
  EXPECT_GT(between, 20u);
}

TEST(FleshSense, LeavesPointsOnTheirAnchors) {
  Line line;
  line.letYield();
  FeltContact contact(line.sense);
  contact.projectAnchors(line.field, line.points, line.around.anchor);
  contact.findYielding(line.field, line.points, line.around.anchor);
  line.project(contact);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double anchor = double{line.around.anchor.x[i]}, left = kRadius_m - anchor;
    const bool felt = left < kYield_m;
    EXPECT_NEAR(line.position.x[i], felt ? anchor : kRadius_m - Line::depth(i), 1e-5) << left;
  }
}

}  // namespace
}  // namespace fascia
