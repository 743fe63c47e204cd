#include <gtest/gtest.h>

#include <fascia/geometry/atlas.h>
#include <fascia/geometry/iso_surface.h>
#include <fascia/geometry/remesh.h>

#include "closed_mesh.h"

namespace fascia {
namespace {

using test::ClosedMesh;

template <class Distance>
ImplicitSurface surfaceOf(double reach_m, const Distance& distance) {
  ImplicitSurface out;
  out.bounds_m.low = Vec3::Constant(-reach_m);
  out.bounds_m.high = Vec3::Constant(reach_m);
  out.evaluate = [distance](ConstVectors points, float* value, Vectors gradient) {
    constexpr double kStep = 1e-4;
    for (std::size_t i = 0; i < points.count; ++i) {
      const Vec3 p(points.x[i], points.y[i], points.z[i]);
      value[i] = static_cast<float>(distance(p));
      Vec3 slope;
      for (int a = 0; a < 3; ++a)
        slope[a] = (distance(p + kStep * Vec3::Unit(a)) - distance(p - kStep * Vec3::Unit(a))) /
                   (2 * kStep);
      gradient.x[i] = static_cast<float>(slope.x());
      gradient.y[i] = static_cast<float>(slope.y());
      gradient.z[i] = static_cast<float>(slope.z());
    }
  };
  return out;
}

double ball(const Vec3& p, double radius) {
  return p.norm() - radius;
}
double ring(const Vec3& p, double radius, double thickness) {
  return Vec2(Vec2(p.x(), p.z()).norm() - radius, p.y()).norm() - thickness;
}
double cross(const Vec3& p) {
  const auto arm = [&](const Vec3& along) {
    const double t = std::clamp(p.dot(along), -0.5, 0.5);
    return (p - t * along).norm() - 0.08;
  };
  return std::min({arm(Vec3::UnitX()), arm(Vec3::UnitY()), arm(Vec3::UnitZ())});
}

const ImplicitSurface kBall = surfaceOf(0.5, [](const Vec3& p) { return ball(p, 0.37); });
const ImplicitSurface kRing = surfaceOf(0.7, [](const Vec3& p) { return ring(p, 0.4, 0.12); });
const ImplicitSurface kCross = surfaceOf(0.7, cross);

double farthestOff(const ImplicitSurface& surface, const TriangleMesh& mesh) {
  double most = 0;
  for (const Eigen::Vector3f& p : mesh.positions) {
    float value, x, y, z;
    surface.evaluate({&p.x(), &p.y(), &p.z(), 1}, &value, {&x, &y, &z, 1});
    most = std::max(most, std::abs(double{value}));
  }
  return most;
}

TEST(IsoSurface, IsClosedAndManifoldWithTheHolesOfTheShape) {
  for (const double cell : {0.031, 0.05, 0.09}) {
    EXPECT_EQ(ClosedMesh(isoSurface(kBall, cell)).euler, 2);
    EXPECT_EQ(ClosedMesh(isoSurface(kRing, cell)).euler, 0);
    const ClosedMesh found(isoSurface(kCross, cell));
    EXPECT_TRUE(found.closed && found.manifold);
    EXPECT_EQ(found.euler, 2);
  }
}

TEST(IsoSurface, EnclosesTheVolumeOfTheShape) {
  const double exact = 4 / 3.0 * kPi * std::pow(0.37, 3);
  EXPECT_NEAR(enclosedVolume(isoSurface(kBall, 0.02)) / exact, 1, 0.01);
  EXPECT_NEAR(enclosedVolume(isoSurface(kRing, 0.02)) / (2 * kPi * 0.4 * kPi * 0.12 * 0.12), 1,
              0.02);
}

TEST(IsoSurface, IsManifoldWhereTheFunctionIsNoise) {
  const ImplicitSurface noise = surfaceOf(0.5, [](const Vec3& p) {
    if (p.cwiseAbs().maxCoeff() > 0.44) return 1.0;
    return std::sin(61 * p.x() + 3 * p.y()) + std::sin(57 * p.y() - 5 * p.z()) +
           std::sin(67 * p.z() + p.x());
  });
  ImplicitSurface rough = noise;
  rough.lipschitz = 1e6;  // nothing may be skipped
  const TriangleMesh mesh = isoSurface(rough, 0.05);
  const ClosedMesh checked(mesh);
  EXPECT_GT(mesh.triangles.size(), 5000u);
  EXPECT_TRUE(checked.closed);
  EXPECT_TRUE(checked.manifold);
}

TEST(IsoSurface, LeavesOutTheWallsOfHollows) {
  const ImplicitSurface shell =
      surfaceOf(0.5, [](const Vec3& p) { return std::abs(ball(p, 0.3)) - 0.06; });
  const TriangleMesh mesh = isoSurface(shell, 0.03);
  EXPECT_EQ(ClosedMesh(mesh).euler, 2);
  for (const Eigen::Vector3f& p : mesh.positions) EXPECT_GT(p.norm(), 0.33f);
}

TEST(Remesh, MakesEvenTrianglesOnTheSurface) {
  for (const ImplicitSurface* surface : {&kBall, &kRing, &kCross}) {
    RemeshOptions options;
    options.edge_m = 0.05;
    const TriangleMesh first = isoSurface(*surface, 0.6 * options.edge_m);
    const TriangleMesh mesh = remeshed(*surface, first, options);
    const ClosedMesh before(first), after(mesh);
    EXPECT_TRUE(after.closed);
    EXPECT_TRUE(after.manifold);
    EXPECT_EQ(after.euler, before.euler);
    EXPECT_LT(farthestOff(*surface, mesh), 1e-4);
    EXPECT_LT(after.longest, 1.65 * options.edge_m);
    EXPECT_GT(after.shortest, 0.35 * options.finest * options.edge_m);
    EXPECT_GT(after.mean, 0.55 * options.edge_m);
    EXPECT_LT(after.mean, 1.1 * options.edge_m);
  }
}

TEST(Remesh, IsFinerWhereTheSurfaceIsCurved) {
  RemeshOptions options;
  options.edge_m = 0.08;
  const auto meanOf = [&](double radius) {
    const ImplicitSurface surface =
        surfaceOf(0.6, [radius](const Vec3& p) { return ball(p, radius); });
    return ClosedMesh(remeshed(surface, isoSurface(surface, 0.03), options)).mean;
  };
  EXPECT_NEAR(meanOf(0.5), 0.08, 0.01);
  EXPECT_NEAR(meanOf(0.1), 0.65 * 0.1, 0.01);
}

TEST(Remesh, HasNoTriangleThatFacesInwards) {
  RemeshOptions options;
  options.edge_m = 0.04;
  const TriangleMesh mesh = remeshed(kCross, isoSurface(kCross, 0.024), options);
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f middle =
        (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3;
    const Eigen::Vector3f normal = (mesh.positions[t[1]] - mesh.positions[t[0]])
                                       .cross(mesh.positions[t[2]] - mesh.positions[t[0]]);
    float value;
    Eigen::Vector3f slope;
    kCross.evaluate({&middle.x(), &middle.y(), &middle.z(), 1}, &value,
                    {&slope.x(), &slope.y(), &slope.z(), 1});
    EXPECT_GT(normal.dot(slope), 0);
  }
}

// Whether two triangles of an atlas lie on each other: by points inside of both.
bool overlap(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b) {
  const auto inside = [](const Vec2& p, const std::array<Vec2, 3>& t) {
    double side[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 edge = t[(k + 1) % 3] - t[k], way = p - t[k];
      side[k] = edge.x() * way.y() - edge.y() * way.x();
    }
    constexpr double kLeast = 1e-9;
    return (side[0] > kLeast && side[1] > kLeast && side[2] > kLeast) ||
           (side[0] < -kLeast && side[1] < -kLeast && side[2] < -kLeast);
  };
  for (int i = 1; i < 8; ++i)
    for (int j = 1; i + j < 8; ++j) {
      const Vec2 p = (i * a[0] + j * a[1] + (8 - i - j) * a[2]) / 8;
      if (inside(p, b)) return true;
    }
  return false;
}

TEST(Atlas, LaysEveryTriangleAloneAndInOneScale) {
  RemeshOptions options;
  options.edge_m = 0.07;
  const TriangleMesh mesh = remeshed(kRing, isoSurface(kRing, 0.04), options);
  const Atlas atlas = makeAtlas(mesh);
  ASSERT_EQ(atlas.triangles.size(), mesh.triangles.size());
  std::vector<std::array<Vec2, 3>> laid;
  for (std::size_t t = 0; t < atlas.triangles.size(); ++t) {
    auto& flat = laid.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(atlas.points[atlas.triangles[t][k]], mesh.triangles[t][k]);
      flat[k] = atlas.uvs[atlas.triangles[t][k]].cast<double>();
      EXPECT_GE(flat[k].minCoeff(), 0);
      EXPECT_LE(flat[k].maxCoeff(), 1);
    }
  }
  for (std::size_t a = 0; a < laid.size(); ++a)
    for (std::size_t b = 0; b < laid.size(); ++b)
      EXPECT_TRUE(a == b || !overlap(laid[a], laid[b])) << a << " " << b;
  EXPECT_LT(atlas.charts, 40u);
}

}  // namespace
}  // namespace fascia
