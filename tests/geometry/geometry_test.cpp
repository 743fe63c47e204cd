#include <gtest/gtest.h>

#include <cmath>

#include <fascia/base/random.h>
#include <fascia/geometry/closest_point.h>
#include <fascia/geometry/triangle_hierarchy.h>

namespace fascia {
namespace {

Vec3 randomPoint(Random& random, double reach = 1) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach),
          random.uniform(-reach, reach)};
}

TriangleMesh unitCube() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.positions.emplace_back(static_cast<float>(i & 1), static_cast<float>(i >> 1 & 1),
                                static_cast<float>(i >> 2 & 1));
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TriangleMesh triangleSoup(Random& random, std::size_t count) {
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 center = randomPoint(random);
    for (int k = 0; k < 3; ++k) {
      mesh.positions.push_back((center + randomPoint(random, 0.2)).cast<float>());
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

TEST(TriangleMesh, VolumeOfAShiftedCubeIsOne) {
  TriangleMesh cube = unitCube();
  EXPECT_NEAR(enclosedVolume(cube), 1, 1e-12);
  for (auto& p : cube.positions) p += Eigen::Vector3f(8, -4, 16);
  EXPECT_NEAR(enclosedVolume(cube), 1, 1e-12);
}

TEST(TriangleMesh, NormalsOfACubePointOutwardAndAreUnit) {
  const TriangleMesh cube = unitCube();
  std::vector<Eigen::Vector3f> normals;
  computeNormals(cube.positions, cube.triangles, normals);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(normals[i].norm(), 1, 1e-6f);
    EXPECT_GT(normals[i].dot(cube.positions[i] - Eigen::Vector3f::Constant(0.5f)), 0.5f);
  }
}

TEST(TriangleMesh, NormalsOfTinyAndOfMissingTrianglesAreUnit) {
  std::vector<Eigen::Vector3f> positions{{0, 0, 0}, {1e-12f, 0, 0}, {0, 1e-12f, 0}, {5, 5, 5}};
  std::vector<Eigen::Vector3f> normals;
  computeNormals(positions, {{0, 1, 2}}, normals);
  EXPECT_NEAR((normals[0] - Eigen::Vector3f::UnitZ()).norm(), 0, 1e-5f);
  EXPECT_EQ(normals[3], Eigen::Vector3f::UnitY());
}

// A sample of the triangle can be no nearer than the answer, and the answer is on the triangle.
TEST(ClosestPoint, IsNoFartherThanAnySampleOfTheTriangle) {
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const Vec3 a = randomPoint(random), b = randomPoint(random), p = randomPoint(random, 2);
    const Vec3 c = i % 10 == 0 ? Vec3(0.3 * a + 0.7 * b) : randomPoint(random);  // no area
    const TrianglePoint nearest = closestPointOnTriangle(p, a, b, c);
    EXPECT_NEAR(nearest.weights.sum(), 1, 1e-12);
    EXPECT_GE(nearest.weights.minCoeff(), 0);
    EXPECT_LT((nearest.weights[0] * a + nearest.weights[1] * b + nearest.weights[2] * c -
               nearest.position)
                  .norm(),
              1e-12);
    for (int u = 0; u <= 12; ++u) {
      for (int v = 0; u + v <= 12; ++v) {
        const Vec3 sample = a + (b - a) * (u / 12.0) + (c - a) * (v / 12.0);
        EXPECT_LE((nearest.position - p).norm(), (sample - p).norm() + 1e-12);
      }
    }
  }
}

TEST(TriangleHierarchy, FindsTheClosestPointThatBruteForceFinds) {
  Random random(2);
  TriangleMesh mesh = triangleSoup(random, 200);
  TriangleHierarchy hierarchy(mesh);
  for (int i = 0; i < 200; ++i) {
    if (i == 100) {
      for (auto& p : mesh.positions) p = 1.5f * p + Eigen::Vector3f(0.1f, 0, 0);
      hierarchy.refit();
    }
    const Vec3 p = randomPoint(random, 2);
    double expected_m = 1e9;
    for (const auto& [a, b, c] : mesh.triangles) {
      const auto corner = [&](std::uint32_t k) { return mesh.positions[k].cast<double>().eval(); };
      const Vec3 q = closestPointOnTriangle(p, corner(a), corner(b), corner(c)).position;
      expected_m = std::min(expected_m, (q - p).norm());
    }
    const auto nearest = hierarchy.closest(p);
    ASSERT_TRUE(nearest);
    EXPECT_NEAR(nearest->distance_m, expected_m, 1e-12);
    EXPECT_FALSE(hierarchy.closest(p, 0.5 * expected_m));
  }
}

TEST(TriangleHierarchy, RaysThroughACubeEnterWhereTheyMust) {
  const TriangleMesh cube = unitCube();
  const TriangleHierarchy hierarchy(cube);
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Vec3 inside(random.uniform(), random.uniform(), random.uniform());
    const Vec3 origin = Vec3::Constant(0.5) + 3 * randomPoint(random).normalized();
    const Vec3 direction = inside - origin;
    double enter = 0;  // the latest of the entries into the three slabs
    for (int k = 0; k < 3; ++k) {
      enter = std::max(enter, ((direction[k] > 0 ? 0 : 1) - origin[k]) / direction[k]);
    }
    const auto hit = hierarchy.firstHit(origin, direction);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, enter, 1e-9);
    EXPECT_FALSE(hierarchy.firstHit(origin, -direction));
    EXPECT_FALSE(hierarchy.firstHit(origin, direction, 0.99 * enter));
  }
}

// One after the other, the first crossings are all of them.
TEST(TriangleHierarchy, AllHitsAreTheFirstAndThoseBehind) {
  const TriangleMesh cube = unitCube();
  const TriangleHierarchy hierarchy(cube);
  Random random(5);
  std::vector<TriangleHierarchy::Hit> hits;
  for (int i = 0; i < 200; ++i) {
    const Vec3 inside(random.uniform(), random.uniform(), random.uniform());
    const Vec3 origin = Vec3::Constant(0.5) + 3 * randomPoint(random).normalized();
    const Vec3 direction = inside - origin;
    hierarchy.allHits(origin, direction, 1e150, hits);
    ASSERT_EQ(hits.size(), 2u);
    const auto first = hierarchy.firstHit(origin, direction);
    ASSERT_TRUE(first);
    EXPECT_EQ(hits[0].triangle, first->triangle);
    EXPECT_EQ(hits[0].t, first->t);
    const auto again = hierarchy.hitOf(hits[1].triangle, origin, direction);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->t, hits[1].t);
    EXPECT_GT(hits[1].t, 1);
    hierarchy.allHits(origin, direction, 1, hits);
    EXPECT_EQ(hits.size(), 1u);
  }
}

TEST(TriangleHierarchy, OfAnEmptyMeshFindsNothing) {
  const TriangleMesh empty;
  const TriangleHierarchy hierarchy(empty);
  EXPECT_FALSE(hierarchy.closest(Vec3::Zero()));
  EXPECT_FALSE(hierarchy.firstHit(Vec3::Zero(), Vec3::UnitX()));
}

}  // namespace
}  // namespace fascia
