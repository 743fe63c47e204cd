#include <gtest/gtest.h>

#include <fascia/math/points.h>
#include <fascia/skin/grid/grid_stretch_limit.h>
#include <fascia/skin/mesh/mesh_stretch_limit.h>

#include "grids.h"

namespace fascia {
namespace {

constexpr double kSpacing_m = 0.01;
constexpr float kLimit = 1.25f;

// A flat sheet in x and y whose points weigh 1 g, and what limits it.
struct Sheet {
  GridLayout layout;
  VectorArray position, velocity;
  PointModel points;
  ElasticGrid grid;
  StretchLimit limit;

  Sheet(int columns, int rows) : layout{columns, rows, false} {
    position.resize(layout.storage()), velocity.resize(layout.storage());
    test::forEachPoint(layout, [&](int i, int j, std::size_t k) {
      setPoint(position, k, kSpacing_m * Vec3(i, j, 0));
    });
    points.free = test::constant(layout, 1);
    points.mass = test::constant(layout, 1e-3);
    GridMaterial material;
    for (FloatArray* a : {&material.stretch_u, &material.stretch_v, &material.shear})
      *a = test::constant(layout, 100);
    material.prestretch = test::constant(layout, 1);
    grid = ElasticGrid(layout, position, material);
    limit = StretchLimit(gridStretchLimits(grid, kLimit));
  }
  void fix(int i, int j) { points.free[layout.at(i, j)] = 0; }
  // Whether anything was too long.
  bool apply() {
    const bool exceeded = limit.exceeded(position, 0.02f);
    limit.apply(points, position, velocity);
    return exceeded;
  }
  // Pulls the last row away along y, all of it at once.
  void pullLastRow(double by_m) {
    for (int i = 0; i < layout.columns; ++i)
      position.y[layout.at(i, layout.rows - 1)] += static_cast<float>(by_m);
  }
};

TEST(StretchLimit, LeavesWhatIsWithinItAlone) {
  Sheet sheet(20, 33);
  test::forEachPoint(sheet.layout, [&](int, int, std::size_t k) {
    sheet.position.y[k] *= 0.99f * kLimit;
    setPoint(sheet.velocity, k, Vec3(0, 3.0 * static_cast<double>(k % 7), 1));
  });
  const Sheet before = sheet;
  EXPECT_FALSE(sheet.apply());
  EXPECT_EQ(sheet.position.y, before.position.y);
  EXPECT_EQ(sheet.velocity.y, before.velocity.y);
}

// Every single edge, by one that is too long alone; those on the border and those that do not fill
// a vector too.
TEST(StretchLimit, SeesEveryEdge) {
  Sheet sheet(19, 5);
  const VectorArray flat = sheet.position;
  test::forEachPoint(sheet.layout, [&](int i, int j, std::size_t k) {
    const Vec3 away = kSpacing_m * Vec3(0, 0, 1);
    setPoint(sheet.position, k, pointAt(flat, k) + away);
    // √2 at all of its edges: beyond 1.25, within 1.25 times 1.2.
    EXPECT_TRUE(sheet.limit.exceeded(sheet.position, 0.1f)) << i << ' ' << j;
    EXPECT_FALSE(sheet.limit.exceeded(sheet.position, 0.2f)) << i << ' ' << j;
    setPoint(sheet.position, k, pointAt(flat, k));
  });
  EXPECT_FALSE(sheet.limit.exceeded(sheet.position, 0));
}

// The last row is taken 2 % of the sheet's length farther than it can go without tearing at it;
// edges alone would pull along few rows of many. The levels are the grid's, or those of its edges.
TEST(StretchLimit, PullsFartherByItsLevels) {
  for (const bool asMesh : {false, true}) {
    for (const int rows : {129, 130}) {
      Sheet sheet(16, rows);
      for (int i = 0; i < 16; ++i) sheet.fix(i, rows - 1);
      sheet.pullLastRow(0.27 * kSpacing_m * rows);
      const std::vector<StretchLimit::Edge> edges =
          gridStretchLimits(sheet.grid, kLimit).back().edges;
      if (asMesh) sheet.limit = StretchLimit(meshStretchLimits(edges));
      Sheet flat = sheet;
      flat.limit = StretchLimit({{edges, {}}});
      for (Sheet* s : {&sheet, &flat})
        for (int interval = 0; interval < 3; ++interval) s->apply();
      EXPECT_LT(sheet.grid.maxStretch(sheet.position), 0.7 * flat.grid.maxStretch(flat.position))
          << rows << ' ' << asMesh;
      for (int interval = 0; interval < 20; ++interval) sheet.apply();
      EXPECT_LT(sheet.grid.maxStretch(sheet.position), 1.6 * kLimit) << rows << ' ' << asMesh;
    }
  }
}

// No chord of a coarser level is longer than the shortest way along the edges.
TEST(StretchLimit, LevelsOfAMeshDoNotContradictEachOther) {
  const Sheet sheet(24, 40);
  const auto levels = meshStretchLimits(gridStretchLimits(sheet.grid, kLimit).back().edges);
  ASSERT_GT(levels.size(), 2u);
  std::size_t edges = 0;
  for (const StretchLimit::Level& level : levels) {
    EXPECT_GT(level.edges.size(), edges);
    edges = level.edges.size();
    for (const StretchLimit::Edge& edge : level.edges) {
      const Vec3 way = pointAt(sheet.position, edge.b) - pointAt(sheet.position, edge.a);
      EXPECT_GE(edge.longest_m, kLimit * way.lpNorm<1>() - 1e-6);
    }
    for (const StretchLimit::Follower& f : level.followers)
      EXPECT_NEAR(f.weights[0] + f.weights[1] + f.weights[2] + f.weights[3], 1, 1e-5);
  }
}

TEST(StretchLimit, KeepsTheCentreOfMassAndMomentum) {
  Sheet sheet(24, 40);
  sheet.pullLastRow(0.05);
  test::forEachPoint(sheet.layout, [&](int i, int j, std::size_t k) {
    setPoint(sheet.velocity, k, Vec3(0.1 * i, j > 20 ? 2 : -1, 0.05 * j));
  });
  const auto sum = [&](const VectorArray& a) {
    Vec3 total = Vec3::Zero();
    test::forEachPoint(sheet.layout, [&](int, int, std::size_t k) { total += pointAt(a, k); });
    return total;
  };
  // On one level; followers take points along without a counterweight.
  sheet.limit = StretchLimit({gridStretchLimits(sheet.grid, kLimit).back()});
  const Vec3 place = sum(sheet.position), momentum = sum(sheet.velocity);
  EXPECT_TRUE(sheet.apply());
  EXPECT_LT((sum(sheet.position) - place).norm(), 1e-4);
  EXPECT_LT((sum(sheet.velocity) - momentum).norm(), 1e-3);
}

TEST(StretchLimit, TakesNothingButWhatParts) {
  Sheet sheet(8, 3);
  sheet.pullLastRow(0.02);
  const auto setSpeeds = [&](double y) {
    for (int i = 0; i < 8; ++i) setPoint(sheet.velocity, sheet.layout.at(i, 2), Vec3(0, y, 0));
  };
  setSpeeds(-1);  // back already
  const VectorArray before = sheet.velocity;
  Sheet parting = sheet;
  EXPECT_TRUE(sheet.apply());
  EXPECT_EQ(sheet.velocity.y, before.y);
  for (int i = 0; i < 8; ++i) setPoint(parting.velocity, parting.layout.at(i, 2), Vec3(0.5, 1, 0));
  EXPECT_TRUE(parting.apply());
  const std::size_t k = parting.layout.at(3, 2);
  EXPECT_LT(parting.velocity.y[k] - parting.velocity.y[parting.layout.at(3, 1)], 0.05f);
  EXPECT_NEAR(parting.velocity.x[k], 0.5f, 1e-3f);
}

TEST(StretchLimit, StaysFiniteOnPointsThatCannotBeBroughtTogether) {
  Sheet sheet(10, 20);
  for (int i = 0; i < 10; ++i) sheet.fix(i, 0), sheet.fix(i, 19);
  sheet.pullLastRow(5);
  for (int frame = 0; frame < 50; ++frame) EXPECT_TRUE(sheet.apply());
  test::forEachPoint(sheet.layout, [&](int, int, std::size_t k) {
    EXPECT_TRUE(pointAt(sheet.position, k).allFinite());
  });
  EXPECT_LT(sheet.grid.maxStretch(sheet.position), 1.5 * 5.19 / 0.19);
}

}  // namespace
}  // namespace fascia
