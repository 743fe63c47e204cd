#include <gtest/gtest.h>

#include <fascia/skin/flesh_contact.h>

#include "test_fields.h"

namespace fascia {
namespace {

using test::RigidSolids;

constexpr double kRadius_m = 0.3, kYield_m = 0.02;
constexpr std::size_t kPoints = 2 * PointBlock::kCapacity;
using Role = FleshContact::Role;

// Two blocks of points on the x axis, and a ball of flesh around the origin beside one far away.
// Point i lies so deep in the first ball, and so do its joints carry it.
struct Line {
  RigidSolids field;
  PointModel points;
  VectorArray position, velocity;
  PointSurroundings around;
  std::vector<PointBlock> blocks;
  FleshSense sense;

  Line() {
    field.addSphere(Vec3::Zero(), kRadius_m).addSphere(Vec3(5, 0, 0), kRadius_m);
    const std::size_t storage = kPoints + PointBlock::kCapacity;  // padding for whole vectors
    position.resize(storage), velocity.resize(storage), around.resize(storage);
    points.fat.assign(storage, 0.f);
    points.free.assign(storage, 1.f);
    for (std::size_t i = 0; i < storage; ++i)
      position.x[i] = static_cast<float>(kRadius_m - depth(i));
    around.carried = position;
    for (std::size_t first = 0; first < kPoints; first += PointBlock::kCapacity)
      blocks.push_back({first, PointBlock::kCapacity});
    sense.felt.assign(blocks.size() * 2, ~std::uint32_t{0});
    sense.yielding.assign(sense.felt.size(), 0);
    sense.yield_m.assign(kPoints, static_cast<float>(kYield_m));
  }
  static double depth(std::size_t i) { return 0.0015 * static_cast<double>(i) + 0.0007; }
  double pushed(std::size_t i) const { return double{position.x[i]} - (kRadius_m - depth(i)); }
  void project(FleshContact& contact) {
    contact.project(field, points, 0.02f, 0.f, position, velocity, around);
  }
  // Bits of the points that `feels` says, for the first ball.
  template <class Feels>
  void setFelt(const Feels& feels) {
    for (std::size_t i = 0; i < kPoints; ++i) {
      std::uint32_t& mask = sense.felt[i / PointBlock::kCapacity * 2];
      const std::uint32_t bit = std::uint32_t{1} << (i % PointBlock::kCapacity);
      mask = feels(i) ? mask | bit : mask & ~bit;
    }
  }
  void letYield() { sense.yielding = sense.felt; }
};

TEST(FleshSense, PushesOnlyPointsThatFeelTheSolid) {
  Line line;
  line.setFelt([](std::size_t i) { return i % 3 != 1; });
  FleshContact contact(line.blocks, &line.sense);
  line.project(contact);
  for (std::size_t i = 0; i < kPoints; ++i) {
    if (i % 3 != 1)
      EXPECT_NEAR(line.pushed(i), Line::depth(i), 1e-5) << i;
    else
      EXPECT_NEAR(line.pushed(i), 0, 1e-7) << i;
  }
}

TEST(FleshSense, LeavesBlocksAloneThatFeelNothing) {
  Line line;
  line.setFelt([](std::size_t i) { return i < PointBlock::kCapacity; });
  FleshContact contact(line.blocks, &line.sense);
  line.project(contact);
  EXPECT_NEAR(line.pushed(20), Line::depth(20), 1e-5);
  for (std::size_t i = PointBlock::kCapacity; i < kPoints; ++i) {
    EXPECT_NEAR(line.pushed(i), 0, 1e-7) << i;
    EXPECT_EQ(line.around.normal.x[i], 0) << i;  // no half space either
  }
}

TEST(FleshSense, MeasuresDepthOnlyWhereSolidsAreFelt) {
  Line line;
  constexpr std::size_t kDeepestFelt = 40;
  line.setFelt([](std::size_t i) { return i <= kDeepestFelt; });
  const FleshContact contact(line.blocks, &line.sense);
  EXPECT_NEAR(contact.deepest(line.field, line.points, line.position, line.around.carried),
              Line::depth(kDeepestFelt), 1e-6);
}

TEST(FleshSense, YieldsWhereThePoseItselfDrivesFleshOverAPoint) {
  Line line;
  line.letYield();
  FleshContact contact(line.blocks, &line.sense);
  line.project(contact);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const bool felt = Line::depth(i) <= kYield_m;
    EXPECT_NEAR(line.pushed(i), felt ? Line::depth(i) : 0, 1e-5) << i;
  }
}

TEST(FleshSense, KeepsPushingWhatItsJointsCarryOutside) {
  Line line;
  line.letYield();
  for (float& x : line.around.carried.x) x = static_cast<float>(kRadius_m) + 0.01f;
  FleshContact contact(line.blocks, &line.sense);
  line.project(contact);
  for (std::size_t i = 0; i < kPoints; ++i) EXPECT_NEAR(line.pushed(i), Line::depth(i), 1e-5) << i;
}

TEST(FleshSense, LetsAnchorsYieldGentlyUpToThreeTimesTheYield) {
  Line line;
  line.letYield();
  FleshContact contact(line.blocks, &line.sense, Role::anchors);
  line.project(contact);
  std::size_t between = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double depth = Line::depth(i);
    const double push = depth <= kYield_m ? depth : kYield_m - 0.5 * (depth - kYield_m);
    if (depth > kYield_m && push > 0) ++between;
    EXPECT_NEAR(line.pushed(i), std::max(0.0, push), 1e-5) << depth;
  }
  EXPECT_GT(between, 20u);
}

TEST(FleshSense, LearnsFromTheAnchorsWhichPointsYield) {
  Line alone;
  alone.letYield();
  FleshContact contact(alone.blocks, &alone.sense);
  alone.project(contact);

  Line line;
  line.letYield();
  FleshContact anchors(line.blocks, &line.sense, Role::anchors), points(line.blocks, &line.sense);
  points.follow(anchors);
  VectorArray anchor = line.position, still = line.velocity;
  PointSurroundings ignored = line.around;
  anchors.project(line.field, line.points, 0.02f, 0.f, anchor, still, ignored);
  line.project(points);
  for (std::size_t i = 0; i < kPoints; ++i)
    EXPECT_NEAR(line.pushed(i), alone.pushed(i), 1e-6) << Line::depth(i);
}

}  // namespace
}  // namespace fascia
