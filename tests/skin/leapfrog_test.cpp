#include <gtest/gtest.h>

#include <fascia/base/parallel.h>

#include "pinned_sheet.h"

namespace fascia {
namespace {

using test::PinnedSheet;

// A sheet thrown out of its plane by a wave of finite size, so that all terms act.
PinnedSheet thrown(PinnedSheet::Options o = {}) {
  o.prestretch = 1.2;
  PinnedSheet sheet(o);
  test::forEachPoint(sheet.layout, [&](int, int, std::size_t k) {
    if (sheet.points.free[k] == 0) return;
    const Vec3 p = test::at(sheet.rest, k);
    const double x = kPi * p.x(), y = kPi * p.y();
    test::put(sheet.position, k,
              p + Vec3(0.02 * std::sin(2 * x) * std::sin(y), 0.03 * std::sin(x) * std::sin(y),
                       0.1 * std::sin(x) * std::sin(2 * y)));
  });
  fillPads(sheet.layout, sheet.position);
  return sheet;
}

constexpr double kFineStep_s = 1.0 / 1024;

TEST(Leapfrog, ConvergesWithSecondOrder) {
  VectorArray result[4];
  GridLayout layout;
  for (int level = 0; level < 4; ++level) {
    PinnedSheet sheet = thrown();
    layout = sheet.layout;
    sheet.prepare(kFineStep_s / (1 << level));
    ASSERT_EQ(*std::max_element(sheet.step.carry.begin(), sheet.step.carry.end()), 0);
    sheet.startFromRest();
    sheet.run(256 << level);
    result[level] = sheet.position;
  }
  const double coarse = test::largestDistance(layout, result[0], result[1]);
  const double middle = test::largestDistance(layout, result[1], result[2]);
  const double fine = test::largestDistance(layout, result[2], result[3]);
  EXPECT_GT(fine, 1e-6);
  EXPECT_NEAR(coarse / middle, 4, 0.5);
  EXPECT_NEAR(middle / fine, 4, 0.5);
}

TEST(Leapfrog, KeepsTheEnergyWithoutDamping) {
  PinnedSheet sheet = thrown();
  sheet.prepare(kFineStep_s);
  sheet.startFromRest();
  const double rest = sheet.elastic.energy(sheet.rest), start = sheet.energy() - rest;
  ASSERT_GT(start, 0.1);
  double lowest = start, highest = start;
  for (int i = 0; i < 400; ++i) {  // 20 seconds
    sheet.run(51);
    lowest = std::min(lowest, sheet.energy() - rest);
    highest = std::max(highest, sheet.energy() - rest);
  }
  EXPECT_GT(lowest, 0.97 * start);
  EXPECT_LT(highest, 1.03 * start);
}

TEST(Leapfrog, LosesEnergyToDragAllTheTime) {
  PinnedSheet::Options o;
  o.drag_Ns_per_m3 = 6;
  PinnedSheet sheet = thrown(o);
  sheet.prepare(0.25 * kFineStep_s);
  sheet.startFromRest();
  const double rest = sheet.elastic.energy(sheet.rest);
  double before = sheet.energy() - rest;
  const double start = before;
  for (int i = 0; i < 100; ++i) {
    sheet.run(80);  // 20 ms: much less than a period of the slowest wave
    const double now = sheet.energy() - rest;
    EXPECT_LT(now, before);
    before = now;
  }
  EXPECT_LT(before, 0.2 * start);
}

TEST(Leapfrog, KeepsMomentumOfAFreeTube) {
  PinnedSheet::Options o;
  o.layout = {33, 12, true};
  o.pinned = false;
  PinnedSheet tube = thrown(o);
  tube.prepare(kFineStep_s);
  Random random(41);
  test::forEachPoint(tube.layout, [&](int, int, std::size_t k) {
    test::put(tube.velocity, k,
              Vec3(random.uniform(-1, 2), random.uniform(-1, 1), random.uniform(-2, 1)));
  });
  const auto momentum = [&](bool angular) {
    Vec3 sum = Vec3::Zero();
    test::forEachPoint(tube.layout, [&](int, int, std::size_t k) {
      // Positions half a step back: the time of the velocities.
      const Vec3 v = test::at(tube.velocity, k);
      const Vec3 r = test::at(tube.position, k) - 0.5 * tube.step.step_s * v;
      sum += tube.points.mass[k] * (angular ? Vec3(r.cross(v)) : v);
    });
    return sum;
  };
  const Vec3 linear = momentum(false), angular = momentum(true);
  ASSERT_GT(linear.norm(), 0.1);
  ASSERT_GT(angular.norm(), 0.01);
  const VectorArray before = tube.position;
  tube.run(1000);
  EXPECT_GT(test::largestDistance(tube.layout, before, tube.position), 0.1);
  EXPECT_LT((momentum(false) - linear).norm(), 1e-4 * linear.norm());
  EXPECT_LT((momentum(true) - angular).norm(), 2e-3 * angular.norm());
}

// Everything a step can do at once, on a grid of an odd width.
PinnedSheet busySheet(const GridLayout& g) {
  PinnedSheet::Options o;
  o.layout = g;
  o.drag_Ns_per_m3 = 4, o.maxStretch = 1.4;
  o.gravity_m_per_s2 = Vec3(0.3, -9.81, 0.1);
  PinnedSheet sheet = thrown(o);
  Random random(42);
  test::forEachPoint(g, [&](int, int, std::size_t k) {
    const Vec3 p = test::at(sheet.rest, k);
    sheet.points.tissueStiffness[k] = static_cast<float>(random.uniform(0, 20));
    sheet.points.tissueDamping[k] = 0.05f;
    sheet.points.tissueRestLength[k] = 0.02f;
    sheet.points.stiffnessBound[k] += sheet.points.tissueStiffness[k];
    test::put(sheet.around.anchor, k, p + Vec3(0, 0, -0.05));
    test::put(sheet.around.anchorVelocity, k, Vec3(0, random.uniform(-1, 1), 0));
    test::put(sheet.around.normal, k, Vec3(0, 0, 1));
    test::put(sheet.around.fleshVelocity, k, Vec3(0.2, 0, random.uniform(-1, 1)));
    sheet.around.offset[k] = static_cast<float>(p.z() - 0.02);
  });
  return sheet;
}

TEST(GridStepper, GivesTheSameBitsForAnyTilingAndThreads) {
  for (const bool closed : {true, false}) {
    const GridLayout g{65, 131, closed};
    constexpr int kSteps = 23;  // several visits of every tile, the last one shorter
    PinnedSheet single = busySheet(g);
    single.prepare(1e-3);
    SweepScratch scratch;
    scratch.resize(g);
    const SweepBand all{
        {single.position.x.data(), single.position.y.data(), single.position.z.data()},
        {single.velocity.x.data(), single.velocity.y.data(), single.velocity.z.data()},
        0};
    for (int s = 1; s <= kSteps; ++s)
      sweepRows(single.model(), all, 0, g.rows, static_cast<float>(s) * single.step.step_s,
                scratch);
    EXPECT_GT(test::largestDistance(g, single.position, single.rest), 0.01);
    for (const int threads : {1, 2, 4}) {
      const ThreadLimit limit(threads);
      PinnedSheet tiled = busySheet(g);
      tiled.prepare(1e-3);
      tiled.run(kSteps);
      EXPECT_TRUE(test::sameBits(g, single.position, tiled.position)) << threads;
      EXPECT_TRUE(test::sameBits(g, single.velocity, tiled.velocity)) << threads;
    }
  }
}

TEST(GridStepper, ContinuesAnIntervalWhereItStopped) {
  const GridLayout g{17, 9, true};
  PinnedSheet whole = busySheet(g), parts = busySheet(g);
  whole.prepare(1e-3), parts.prepare(1e-3);
  whole.run(10);
  parts.stepper.run(parts.model(), 0, 4, parts.position, parts.velocity);
  parts.stepper.run(parts.model(), 4, 6, parts.position, parts.velocity);
  EXPECT_TRUE(test::sameBits(g, whole.position, parts.position));
  parts.stepper.run(parts.model(), 0, 4, parts.position, parts.velocity);
  whole.stepper.run(whole.model(), 10, 4, whole.position, whole.velocity);
  EXPECT_FALSE(test::sameBits(g, whole.position, parts.position));  // surroundings move with time
}

}  // namespace
}  // namespace fascia
