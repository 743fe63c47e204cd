#include <gtest/gtest.h>

#include <fascia/geometry/triangle_hierarchy.h>
#include <fascia/skin/grid/flesh_path.h>
#include <fascia/skin/grid/wrap.h>
#include <fascia/skin/skin_fit.h>

#include "test_fields.h"

namespace fascia {
namespace {

using test::RigidSolids;

EndRing ring(const Field& field, const Vec3& origin, const Vec3& axis, double radius_m,
             double fat_m) {
  return {exitPoint(field, origin, axis, fat_m), axis, radius_m};
}

VectorArray wrap(const RigidSolids& field, const GridLayout& g, const WrapOptions& options) {
  Box box;
  for (std::size_t s = 0; s < field.solidCount(); ++s)
    box.add(field.bounds(SolidId(static_cast<std::int64_t>(s))));
  const double radius = 0.03 * box.size().norm();
  const RigidSolids::Part &first = field.parts.front(), &last = field.parts.back();
  return shrinkWrap(
      field, g, ring(field, first.world.translation_m, -Vec3::UnitY(), radius, options.fat_m),
      ring(field, last.world.translation_m, Vec3::UnitY(), radius, options.fat_m), options);
}

RigidSolids snowman() {
  return RigidSolids()
      .addSphere(Vec3(0, 0, 0), 0.3)
      .addSphere(Vec3(0, 0.4, 0.02), 0.2)
      .addSphere(Vec3(0.02, 0.68, 0), 0.13);
}

TriangleMesh meshOf(const GridLayout& g, const VectorArray& r) {
  TriangleMesh mesh;
  test::forEachPoint(g, [&](int i, int j, std::size_t k) {
    mesh.positions.push_back(test::at(r, k).cast<float>());
    if (j + 1 == g.rows) return;
    const auto vertex = [&](int column, int row) {
      return static_cast<std::uint32_t>(row * g.columns + g.wrapped(column));
    };
    mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
    mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
  });
  return mesh;
}

double farthest(const TriangleMesh& from, const TriangleMesh& to) {
  const TriangleHierarchy tree(to);
  double largest = 0;
  for (const Eigen::Vector3f& p : from.positions)
    largest = std::max(largest, tree.closest(p.cast<double>())->distance_m);
  return largest;
}

TEST(ShrinkWrap, LiesOnASphereAtTheDistanceOfTheFat) {
  const Vec3 center(0.1, 0.2, -0.1);
  const RigidSolids field = RigidSolids().addSphere(center, 0.25);
  for (const GridLayout g : {GridLayout{16, 16}, {32, 24}, {47, 65}}) {
    const double fat = 0.02;
    const VectorArray r = wrap(field, g, {.fat_m = fat, .cling = 0.3});
    double farthest = 0, nearest = 1;
    test::forEachPoint(g, [&](int, int j, std::size_t k) {
      if (j < 2 || j + 2 >= g.rows) return;  // the flat end rings and the rows that they hold up
      const double distance = (test::at(r, k) - center).norm() - 0.25;
      farthest = std::max(farthest, distance);
      nearest = std::min(nearest, distance);
    });
    EXPECT_NEAR(farthest, fat, 0.01 * fat) << g.rows;
    EXPECT_NEAR(nearest, fat, 0.01 * fat) << g.rows;
  }
}

TEST(ShrinkWrap, EndsOnItsRings) {
  const RigidSolids field = snowman();
  const GridLayout g{24, 33};
  const EndRing bottom{Vec3(0, -0.31, 0), Vec3(0.1, -1, 0).normalized(), 0.04};
  const EndRing top{Vec3(0, 0.83, 0), Vec3(0, 1, 0.2).normalized(), 0.02};
  const VectorArray r = shrinkWrap(field, g, bottom, top, {});
  const Vec3 up = (top.center_m - bottom.center_m).normalized();
  for (int i = 0; i < g.columns; ++i) {
    const double u = static_cast<double>(i) / g.columns;
    for (const auto& [end, j] : {std::pair{&bottom, 0}, {&top, g.rows - 1}}) {
      const Vec3 p = test::at(r, g.at(i, j));
      EXPECT_LT((p - ringPoint(*end, up, u)).norm(), 1e-6);
      EXPECT_NEAR((p - end->center_m).norm(), end->radius_m, 1e-6);
      EXPECT_NEAR((p - end->center_m).dot(end->axis), 0, 1e-6);
    }
  }
}

TEST(ShrinkWrap, TurnsItsNormalsOutwardsAndItsSeamToTheBack) {
  const RigidSolids field = RigidSolids().addSphere(Vec3(0.1, 0.2, -0.1), 0.25);
  const GridLayout g{33, 32};
  const VectorArray r = wrap(field, g, {});
  VectorArray normal(g.storage());
  gridNormals(g, r, 0, g.rows, normal);
  test::forEachPoint(g, [&](int, int j, std::size_t k) {
    if (j < 2 || j + 3 > g.rows) return;
    const Vec3 outward = (test::at(r, k) - Vec3(0.1, 0.2, -0.1)).normalized();
    EXPECT_GT(test::at(normal, k).dot(outward), 0.98);
  });
  EXPECT_LT(r.z[g.at(0, 16)], -0.3);  // behind the centre
  EXPECT_NEAR(r.x[g.at(0, 16)], 0.1, 1e-3);
}

TEST(ShrinkWrap, StaysOutsideOfEveryBody) {
  const Transform turned{Eigen::AngleAxisd(0.4, Vec3::UnitX()).matrix(), Vec3(0, 0.3, 0)};
  const RigidSolids bodies[] = {snowman(),
                                RigidSolids()
                                    .addSphere(Vec3(0, -0.1, 0), 0.2)
                                    .add(test::superellipsoid(0.3, 0.2, 0.1, 0.6, 0.6), turned)
                                    .addSphere(Vec3(0, 0.55, 0.1), 0.1)};
  for (const RigidSolids& body : bodies) {
    for (const double cling : {0.0, 0.3, 1.0}) {
      const GridLayout g{32, 40};
      const VectorArray r = wrap(body, g, {.fat_m = 0.01, .cling = cling});
      test::forEachPoint(g, [&](int, int j, std::size_t k) {
        const bool end = j == 0 || j + 1 == g.rows;
        EXPECT_GE(body.distance(test::at(r, k)), end ? 0 : 0.0099);
      });
    }
  }
}

TEST(ShrinkWrap, ClingsDeeperIntoValleysWhenAsked) {
  const GridLayout g{32, 64};
  double gap[2];
  for (int n = 0; n < 2; ++n) {
    const RigidSolids field = snowman();
    const VectorArray r = wrap(field, g, {.fat_m = 0.01, .cling = n == 0 ? 0.0 : 1.0});
    gap[n] = 0;
    test::forEachPoint(g, [&](int, int j, std::size_t k) {
      if (j > 0 && j + 1 < g.rows) gap[n] = std::max(gap[n], field.distance(test::at(r, k)));
    });
  }
  EXPECT_LT(gap[1], 0.7 * gap[0]);
}

TEST(ShrinkWrap, KeepsItsShapeAtEveryResolution) {
  for (const double cling : {0.3, 0.8}) {
    TriangleMesh mesh[3];
    for (int level = 0; level < 3; ++level) {
      const GridLayout g{32 << level, 32 << level};
      mesh[level] = meshOf(g, wrap(snowman(), g, {.fat_m = 0.01, .cling = cling}));
    }
    // Along the body a row covers about 1.5 m / rows: within 0.15 of a cell.
    for (int level = 0; level < 2; ++level) {
      const double limit = 0.15 * 1.5 / (32 << level);
      EXPECT_LT(farthest(mesh[level], mesh[2]), limit) << level << " cling " << cling;
      EXPECT_LT(farthest(mesh[2], mesh[level]), limit) << level << " cling " << cling;
    }
  }
}

TEST(ShrinkWrap, StaysFiniteAroundAwkwardFlesh) {
  const RigidSolids bodies[] = {
      RigidSolids().addSphere(Vec3(0, -2, 0), 0.1).addSphere(Vec3(0.5, 2, 0), 0.3),  // far apart
      RigidSolids().addSphere(Vec3::Zero(), 1e-4),
      RigidSolids().addSphere(Vec3(1000, 500, -800), 50),
      RigidSolids().addSphere(Vec3::Zero(), 0.3).addSphere(Vec3(0.001, 0, 0), 0.3),
      RigidSolids().addSphere(Vec3(0, 0, -1), 0.2).addSphere(Vec3(0, 0, 1), 0.2)};
  for (const RigidSolids& body : bodies) {
    const GridLayout g{16, 24};
    const VectorArray r = wrap(body, g, {.fat_m = 0.01, .cling = 1});
    Box box;
    for (std::size_t s = 0; s < body.solidCount(); ++s)
      box.add(body.bounds(SolidId(static_cast<std::int64_t>(s))));
    const Vec3 reach = Vec3::Constant(0.05 + 0.6 * box.size().norm());
    test::forEachPoint(g, [&](int, int, std::size_t k) {
      const Vec3 p = test::at(r, k);
      EXPECT_TRUE(p.allFinite());
      EXPECT_TRUE(((p - box.center()).cwiseAbs().array() < reach.array()).all()) << p.transpose();
    });
  }
}

TEST(ExitPoint, IsWhereTheRayLeavesTheFleshForTheLastTime) {
  const RigidSolids field =
      RigidSolids().addSphere(Vec3::Zero(), 0.1).addSphere(Vec3(0, 0.5, 0), 0.2);
  const Vec3 p = exitPoint(field, Vec3::Zero(), Vec3::UnitY(), 0.03);
  EXPECT_LT((p - Vec3(0, 0.73, 0)).norm(), 1e-5);
  EXPECT_LT((exitPoint(field, Vec3::Zero(), -Vec3::UnitY(), 0.03) - Vec3(0, -0.13, 0)).norm(),
            1e-5);
}

// Balls along an arc in the plane of x and y, and what lies on the way between its ends.
RigidSolids arcOfBalls(double degrees_along) {
  RigidSolids field;
  const int count = static_cast<int>(degrees_along / 9);
  for (int i = 0; i <= count; ++i) {
    const double a = radians(degrees_along) * i / count;
    field.addSphere(0.5 * Vec3(std::cos(a), std::sin(a), 0), 0.08);
  }
  return field;
}
RigidSolids snakeOfBalls() {
  RigidSolids field;
  for (int i = 0; i <= 60; ++i)
    field.addSphere(Vec3(0.35 * std::sin(2 * kPi * i / 40.0), 0, 0.035 * i), 0.06);
  return field;
}

struct PathWrap {
  GridLayout g{24, 120, true};
  VectorArray r;
  TriangleMesh mesh;  // closed

  explicit PathWrap(const RigidSolids& field) {
    const auto end = [&](std::size_t at, std::size_t next) {
      const Vec3 here = field.parts[at].world.translation_m;
      const Vec3 axis = (here - field.parts[next].world.translation_m).normalized();
      return ring(field, here, axis, 0.02, 0.01);
    };
    const std::size_t last = field.parts.size() - 1;
    r = wrapAlongFlesh(field, g, end(0, 1), end(last, last - 1), {.fat_m = 0.01, .cling = 0.3});
    mesh = meshOf(g, r);
    for (const int row : {0, g.rows - 1})
      for (int i = 1; i + 1 < g.columns; ++i) {
        const auto first = static_cast<std::uint32_t>(row * g.columns),
                   a = first + static_cast<std::uint32_t>(i);
        mesh.triangles.push_back(row == 0 ? std::array{first, a + 1, a}
                                          : std::array{first, a, a + 1});
      }
  }
};

TEST(WrapAlongFlesh, HoldsArcsAndSnakesWithoutCrossings) {
  for (const RigidSolids& field :
       {arcOfBalls(90), arcOfBalls(180), arcOfBalls(270), snakeOfBalls()}) {
    const PathWrap wrap(field);
    const SkinFit fit = findSkinFit(field, wrap.mesh);
    EXPECT_TRUE(fit.outside.empty()) << fit.outside.size();
    EXPECT_EQ(fit.crossings, 0u);
    EXPECT_GT(enclosedVolume(wrap.mesh), 0);
  }
}

TEST(WrapAlongFlesh, SpreadsItsRowsEvenly) {
  const PathWrap wrap(arcOfBalls(180));
  double least = 1e300, most = 0;
  for (int j = 2; j + 3 < wrap.g.rows; ++j) {
    Vec3 way = Vec3::Zero();
    for (int i = 0; i < wrap.g.columns; ++i)
      way += (test::at(wrap.r, wrap.g.at(i, j + 1)) - test::at(wrap.r, wrap.g.at(i, j))) /
             wrap.g.columns;
    least = std::min(least, way.norm()), most = std::max(most, way.norm());
  }
  EXPECT_LT(most / least, 2.5);
}

TEST(PathThroughFlesh, LeadsAlongAnArcAndNotAcross) {
  const RigidSolids field = arcOfBalls(270);
  const Vec3 from(0.5, -0.09, 0), to(-0.09, -0.5, 0);
  const std::vector<Vec3> path = pathThroughFlesh(field, from, to, 50);
  ASSERT_EQ(path.size(), 50u);
  EXPECT_LT((path.front() - from).norm(), 1e-12);
  EXPECT_LT((path.back() - to).norm(), 1e-12);
  double least = 1e300, most = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    EXPECT_NEAR(path[i].norm(), 0.5, 0.03);
    least = std::min(least, (path[i] - path[i - 1]).norm());
    most = std::max(most, (path[i] - path[i - 1]).norm());
  }
  EXPECT_LT(most / least, 1.05);
}

}  // namespace
}  // namespace fascia
