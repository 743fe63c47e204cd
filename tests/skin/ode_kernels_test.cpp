#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include <fascia/skin/ode_kernels.h>

#include "grids.h"

namespace fascia {
namespace {

// Points on strands of all kinds: taut, slack, without a rest length, none.
struct HeldPoints {
  GridLayout layout{37, 5, false};
  std::vector<SkinTopology::Range> ranges;
  PointModel points;
  PointSurroundings around;
  VectorArray position, velocity, force;
  FloatArray inverseMass;

  HeldPoints() {
    const std::size_t storage = layout.storage();
    for (VectorArray* a : {&position, &velocity, &force}) a->resize(storage);
    around.resize(storage);
    for (FloatArray* a : {&points.mass, &points.drag, &points.tissueStiffness,
                          &points.tissueDamping, &points.tissueRestLength, &inverseMass})
      a->assign(storage, 0.f);
    for (int j = 0; j < layout.rows; ++j)
      ranges.push_back({layout.row(j), static_cast<std::size_t>(layout.columns)});
    Random random(7);
    test::forEachPoint(layout, [&](int i, int, std::size_t k) {
      const auto within = [&](double r) {
        return Vec3(random.uniform(-r, r), random.uniform(-r, r), random.uniform(-r, r));
      };
      test::put(position, k, within(0.3));
      test::put(velocity, k, within(2));
      test::put(force, k, within(5));
      test::put(around.anchor, k, within(0.3));
      test::put(around.anchorVelocity, k, within(1));
      points.mass[k] = 0.2f + 0.01f * static_cast<float>(i);
      points.drag[k] = 0.7f;
      points.tissueStiffness[k] = i % 5 == 4 ? 0.f : 40.f;
      points.tissueDamping[k] = 3;
      points.tissueRestLength[k] = i % 3 == 0 ? 0.f : i % 3 == 1 ? 0.05f : 2.f;
      inverseMass[k] = i % 7 == 6 ? 0.f : 1 / points.mass[k];
    });
  }
  StrandScene scene() const { return {ranges, &points, &around, 0.01f, {0, -9.81f, 0}}; }
  std::size_t count() const { return layout.pointCount(); }
};

TEST(MidpointKick, IsWhatTheIterationOverVelocityForcesGoesTo) {
  const HeldPoints held;
  const float h = 0.05f;
  VectorArray change = held.velocity, damping = held.velocity;
  midpointKicks(held.scene(), held.inverseMass, h, held.position, held.velocity, held.force,
                change);
  VectorArray middle = held.velocity;
  test::forEachPoint(held.layout, [&](int, int, std::size_t k) {
    test::put(middle, k, test::at(held.velocity, k) + 0.5 * test::at(change, k));
  });
  dampingForces(held.scene(), held.position, middle, damping);
  double fastest = 0;
  int fixed = 0;
  test::forEachPoint(held.layout, [&](int, int, std::size_t k) {
    const Vec3 total = test::at(held.force, k) + test::at(damping, k);
    const Vec3 kick = double{h} * held.inverseMass[k] * total;
    EXPECT_LT((test::at(change, k) - kick).norm(), 2e-6 * (1 + kick.norm()));
    fastest = std::max(fastest, kick.norm());
    fixed += held.inverseMass[k] == 0;
  });
  EXPECT_GT(fastest, 0.5);
  EXPECT_GT(fixed, 10);
}

TEST(DampingForces, ActAlongTautStrandsAndOnAllSidesOfThoseWithoutALength) {
  const HeldPoints held;
  VectorArray damping = held.velocity, pull = held.force;
  pull.fill(0.f);
  dampingForces(held.scene(), held.position, held.velocity, damping);
  addStrandForces(held.scene(), held.position, pull);
  int kinds[4] = {};
  test::forEachPoint(held.layout, [&](int, int, std::size_t k) {
    const PointModel& p = held.points;
    const Vec3 way = test::at(held.position, k) - test::at(held.around.anchor, k) -
                     0.01 * test::at(held.around.anchorVelocity, k);
    const Vec3 v = test::at(held.velocity, k), n = way.normalized();
    const Vec3 relative = v - test::at(held.around.anchorVelocity, k);
    const double extension = way.norm() - p.tissueRestLength[k];
    const bool taut = p.tissueStiffness[k] > 0 && extension > 0;
    const bool allSides = p.tissueRestLength[k] == 0;
    Vec3 expected = -double{p.drag[k]} * v;
    if (taut) expected -= p.tissueDamping[k] * (allSides ? relative : n * n.dot(relative));
    Vec3 expectedPull = p.mass[k] * Vec3(0, -9.81, 0);
    if (taut) expectedPull -= p.tissueStiffness[k] * extension * n;
    EXPECT_LT((test::at(damping, k) - expected).norm(), 2e-5);
    EXPECT_LT((test::at(pull, k) - expectedPull).norm(), 2e-5);
    ++kinds[taut ? (allSides ? 1 : 2) : (p.tissueStiffness[k] > 0 ? 3 : 0)];
  });
  for (const int kind : kinds) EXPECT_GT(kind, 10);
}

TEST(Coordinates, GoToStorageAndBackWithoutLoss) {
  HeldPoints held;
  std::vector<double> values(3 * held.count());
  Random random(3);
  for (double& x : values) x = random.uniform(-1, 1);
  const std::vector<double> before = values;
  VectorArray loaded = held.position;
  loadCoordinates(held.ranges, values, loaded);
  takeChanges(held.ranges, loaded, values);
  EXPECT_EQ(values, before);  // nothing has changed, in double precision

  std::size_t p = 0;
  test::forEachPoint(held.layout, [&](int i, int, std::size_t k) {
    EXPECT_EQ(loaded.y[k], static_cast<float>(before[3 * p + 1]));
    if (i % 4 == 0) loaded.y[k] += 0.25f;
    ++p;
  });
  takeChanges(held.ranges, loaded, values);
  std::vector<double> sums(values.size());
  addCoordinates(held.ranges, held.force, values, sums);
  p = 0;
  test::forEachPoint(held.layout, [&](int i, int, std::size_t k) {
    EXPECT_NEAR(values[3 * p + 1] - before[3 * p + 1], i % 4 == 0 ? 0.25 : 0, 1e-7);
    EXPECT_EQ(values[3 * p], before[3 * p]);
    EXPECT_EQ(sums[3 * p + 2], values[3 * p + 2] + double{held.force.z[k]});
    ++p;
  });
}

}  // namespace
}  // namespace fascia
