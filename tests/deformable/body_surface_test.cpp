#include <gtest/gtest.h>

#include <fascia/base/error.h>
#include <fascia/base/random.h>
#include <fascia/deformable/surfaces/body_surface.h>

namespace fascia {
namespace {

struct SurfaceValue {
  double distance_m;
  Vec3 normal;
};

SurfaceValue valueAt(const BodySurface& surface, const Vec3& p) {
  const Eigen::Vector3f x = p.cast<float>();
  float d = 0, nx = 0, ny = 0, nz = 0;
  surface.evaluate({&x.x(), &x.y(), &x.z(), 1}, &d, {&nx, &ny, &nz, 1});
  return {d, Vec3(nx, ny, nz)};
}

// The unit cube, or a part of its faces.
TriangleMesh cubeMesh(std::size_t triangles = 12) {
  TriangleMesh mesh;
  for (unsigned c = 0; c < 8; ++c)
    mesh.positions.emplace_back(float(c & 1u) - 0.5f, float((c >> 1) & 1u) - 0.5f,
                                float((c >> 2) & 1u) - 0.5f);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  mesh.triangles.resize(triangles);
  return mesh;
}

// Closed form (signed distance of a box).
double boxDistance(const Vec3& p, const Vec3& half) {
  const Vec3 q = p.cwiseAbs() - half;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

void expectBoxDistances(const BodySurface& surface, const Vec3& half) {
  Random random(5);
  for (int i = 0; i < 400; ++i) {
    const Vec3 p = 1.7 * half.cwiseProduct(Vec3(random.uniform(-1, 1), random.uniform(-1, 1),
                                                random.uniform(-1, 1)));
    const SurfaceValue value = valueAt(surface, p);
    EXPECT_NEAR(value.distance_m, boxDistance(p, half), 1e-6);
    EXPECT_NEAR(value.normal.norm(), 1, 1e-5);
    // Back along the normal lies the surface.
    EXPECT_NEAR(boxDistance(p - value.distance_m * value.normal, half), 0, 2e-6);
  }
}

TEST(BodySurface, MeshDistancesAreExact) {
  expectBoxDistances(*makeMeshSurface(cubeMesh()), Vec3::Constant(0.5));
}

TEST(BodySurface, PlateDistancesAreExact) {
  const std::vector<Vec2> square{{-0.5, -0.3}, {0.5, -0.3}, {0.5, 0.3}, {-0.5, 0.3}};
  for (const auto& outline : {square, std::vector<Vec2>(square.rbegin(), square.rend())})
    expectBoxDistances(*makeOutlineSurface(outline, 0.2), Vec3(0.5, 0.3, 0.1));
}

TEST(BodySurface, PlateWithABayKnowsInsideFromOutside) {
  const std::vector<Vec2> bay{{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  const auto surface = makeOutlineSurface(bay, 4);
  EXPECT_NEAR(valueAt(*surface, Vec3(1.5, 1.5, 0)).distance_m, 0.5, 1e-6);
  EXPECT_NEAR(valueAt(*surface, Vec3(0.4, 1.5, 0)).distance_m, -0.4, 1e-6);
  EXPECT_NEAR(valueAt(*surface, Vec3(1.5, 0.9, 0)).distance_m, -0.1, 1e-6);
  EXPECT_NEAR(valueAt(*surface, Vec3(2, 1, 0)).distance_m, 0, 1e-6);
}

TEST(BodySurface, SolidKeepsItsOwnDistances) {
  Diagnostics diagnostics;
  const Solid solid({"sphere", {0.3}, {}}, "", diagnostics);
  const auto surface = makeSolidSurface(solid, 24);
  EXPECT_NEAR(valueAt(*surface, Vec3(0, 0.5, 0)).distance_m, 0.2, 1e-6);
  EXPECT_NEAR(enclosedVolume(surface->mesh()), solid.volume_m3(), 0.05 * solid.volume_m3());
}

TEST(BodySurface, MeshesOfOutlinesAreClosedAndFine) {
  const std::vector<Vec2> bay{{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  const TriangleMesh mesh = makeOutlineSurface(bay, 0.5)->mesh();
  EXPECT_NEAR(enclosedVolume(mesh), 5 * 0.5, 1e-4);
  EXPECT_NO_THROW(makeMeshSurface(mesh));  // which refuses open ones
  for (const auto& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c) {
      const Eigen::Vector3f edge = mesh.positions[t[c]] - mesh.positions[t[(c + 1) % 3]];
      EXPECT_LT(edge.head<2>().norm(), 3.0f / 20);
    }
}

TEST(BodySurface, RimsAreSmoothWhereTheyTurnLittle) {
  std::vector<Vec2> disk;
  for (int i = 0; i < 40; ++i)
    disk.emplace_back(std::cos(2 * kPi * i / 40), std::sin(2 * kPi * i / 40));
  const TriangleMesh mesh = makeOutlineSurface(disk, 0.2)->mesh();
  int rim = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (mesh.normals[i].z() != 0) continue;
    ++rim;
    const Eigen::Vector2f radial = mesh.positions[i].head<2>().normalized();
    EXPECT_GT(mesh.normals[i].head<2>().dot(radial), 0.9999f);
  }
  EXPECT_GE(rim, 4 * 40);
}

TEST(BodySurface, RefusesWhatHasNoInside) {
  EXPECT_THROW(makeMeshSurface(cubeMesh(11)), Error);
  EXPECT_THROW(makeMeshSurface({}), Error);
  TriangleMesh inward = cubeMesh();
  for (auto& t : inward.triangles) std::swap(t[0], t[1]);
  EXPECT_THROW(makeMeshSurface(inward), Error);
  const std::vector<Vec2> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_THROW(makeOutlineSurface(square, 0), Error);
  EXPECT_THROW(makeOutlineSurface(std::vector<Vec2>{{0, 0}, {1, 1}, {1, 0}, {0, 1}}, 1), Error);
}

}  // namespace
}  // namespace fascia
