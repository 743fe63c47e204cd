#include <gtest/gtest.h>

#include <fascia/base/error.h>
#include <fascia/body/body_surface.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/world/inflate.h>
#include <fascia/world/outline_curve.h>

namespace fascia {
namespace {

std::vector<Vec2> circle(int count) {
  std::vector<Vec2> out;
  for (int i = 0; i < count; ++i)
    out.emplace_back(std::cos(2 * kPi * i / count), std::sin(2 * kPi * i / count));
  return out;
}

double worstRadius(int count) {
  double worst = 0;
  for (const Vec2& p : closedCurve(circle(count))) worst = std::max(worst, std::abs(p.norm() - 1));
  return worst;
}

// A Catmull–Rom spline meets a smooth curve in third order or better.
TEST(ClosedCurve, ThroughPointsOfACircleConvergesToIt) {
  EXPECT_LT(worstRadius(8), 0.02);
  EXPECT_LT(worstRadius(16), worstRadius(8) / 8);
  EXPECT_LT(worstRadius(32), worstRadius(16) / 8);
}

TEST(ClosedCurve, GoesThroughItsPointsAndKeepsCorners) {
  const std::vector<Vec2> corner{{0, 0}, {0, 0}, {2, 0}, {2, 0}, {1, 1}};
  const std::vector<Vec2> curve = closedCurve(corner);
  for (const Vec2& p : corner)
    EXPECT_TRUE(std::ranges::any_of(curve, [&](const Vec2& c) { return (c - p).norm() < 1e-12; }));
  // Between two corners it is straight.
  for (const Vec2& p : curve) EXPECT_GT(p.y(), -1e-12);
  EXPECT_EQ(std::ranges::count_if(curve, [](const Vec2& p) { return std::abs(p.y()) < 1e-12; }), 9);
}

TEST(ClosedCurve, LeavesWhatIsNoOutlineToTheCheckOfOutlines) {
  EXPECT_EQ(closedCurve(std::vector<Vec2>{{0, 0}, {1, 0}}).size(), 2u);
  EXPECT_TRUE(closedCurve(std::vector<Vec2>{}).empty());
  EXPECT_TRUE(closedCurve(std::vector<Vec2>(5, Vec2(1, 1))).empty());
}

// A round plate becomes an ellipsoid of revolution.
TEST(Inflate, TurnsARoundPlateIntoAnEllipsoid) {
  const BodySurfacePtr plate = makeOutlineSurface(circle(128), 0.4);
  TriangleMesh mesh = plate->mesh();
  inflate(*plate, mesh);
  for (const Eigen::Vector3f& p : mesh.positions)
    EXPECT_NEAR(p.z() * p.z() / 0.04f + p.head<2>().squaredNorm(), 1, 0.02);
  EXPECT_NEAR(enclosedVolume(mesh), 4.0 / 3 * kPi * 0.2, 0.05);
}

}  // namespace
}  // namespace fascia
