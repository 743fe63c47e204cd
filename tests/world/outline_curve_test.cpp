#include <gtest/gtest.h>

#include <fascia/base/error.h>
#include <fascia/deformable/surfaces/body_surface.h>
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

// A round plate of radius R + a and thickness 2a becomes a disc of radius R inside of half a torus.
TEST(Inflate, GivesARoundPlateTheRimOfATorus) {
  const double R = 0.8, a = 0.2;
  const BodySurfacePtr plate = makeOutlineSurface(circle(128), 2 * a);
  TriangleMesh mesh = plate->mesh();
  inflate(*plate, mesh);
  for (const Eigen::Vector3f& p : mesh.positions) {
    const double beyond = std::max(0.0, static_cast<double>(p.head<2>().norm()) - R);
    EXPECT_NEAR(std::hypot(beyond, p.z()), a, 2e-3);
  }
  const double volume = kPi * R * R * 2 * a + kPi * kPi * a * a * R + 4.0 / 3 * kPi * a * a * a;
  EXPECT_NEAR(enclosedVolume(mesh), volume, 0.03 * volume);
}

}  // namespace
}  // namespace fascia
