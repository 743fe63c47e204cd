#include <gtest/gtest.h>

#include <cmath>

#include <fascia/field/reference.h>

#include "solids.h"

namespace fascia {
namespace {

VectorArray randomPoints(Random& random, std::size_t count, double reach_m) {
  VectorArray points(count);
  for (std::size_t i = 0; i < count; ++i) {
    points.x[i] = static_cast<float>(random.uniform(-reach_m, reach_m));
    points.y[i] = static_cast<float>(random.uniform(-reach_m, reach_m));
    points.z[i] = static_cast<float>(random.uniform(-reach_m, reach_m));
  }
  return points;
}

Vec3 at(const VectorArray& a, std::size_t i) {
  return Eigen::Vector3f(a.x[i], a.y[i], a.z[i]).cast<double>();
}

TEST(Kernels, EqualTheScalarReferenceAtOddLengths) {
  Random random(31);
  for (const SolidDef& def : assortedSolids()) {
    const Solid solid = makeSolid(def);
    for (const std::size_t count : {1u, 7u, 16u, 33u}) {
      const VectorArray points = randomPoints(random, count, 0.25);
      VectorArray normals(count);
      FloatArray distance_m(count);
      solid.evaluate(view(points, 0, count), distance_m.data(), view(normals, 0, count));
      for (std::size_t i = 0; i < count; ++i) {
        const FieldSample expected = evaluateReference(solid, at(points, i));
        EXPECT_NEAR(static_cast<double>(distance_m[i]), expected.distance_m, 2e-6)
            << def.shape << " " << at(points, i).transpose();
        EXPECT_LT((at(normals, i) - expected.normal).norm(), 2e-3)
            << def.shape << " " << at(points, i).transpose();
      }
    }
  }
}

TEST(Kernels, WriteNothingBeyondTheirPoints) {
  Random random(32);
  const Solid solid = makeSolid({"sphere", {0.1}, {}});
  const VectorArray points = randomPoints(random, 7, 0.2);
  VectorArray normals(8);
  FloatArray distance_m(8, 42.0f);
  normals.fill(42.0f);
  solid.evaluate(view(points, 0, 7), distance_m.data(), view(normals, 0, 7));
  EXPECT_EQ(distance_m[7], 42.0f);
  EXPECT_EQ(normals.x[7] + normals.y[7] + normals.z[7], 126.0f);
}

// The skin may cut its points into blocks as it likes.
TEST(Kernels, GiveTheSameBitsHoweverPointsAreBatched) {
  Random random(33);
  for (const SolidDef& def : assortedSolids()) {
    const Solid solid = makeSolid(def);
    const VectorArray points = randomPoints(random, 33, 0.2);
    VectorArray together(33), single(33);
    FloatArray distances_m(33);
    solid.evaluate(view(points, 0, 33), distances_m.data(), view(together, 0, 33));
    for (std::size_t i = 0; i < 33; ++i) {
      float distance_m = 0;
      solid.evaluate(view(points, i, 1), &distance_m, view(single, i, 1));
      EXPECT_EQ(distance_m, distances_m[i]) << def.shape;
      EXPECT_EQ(at(single, i), at(together, i)) << def.shape;
    }
  }
}

TEST(Kernels, FollowTheSolidIntoTheWorld) {
  Random random(34);
  const Solid solid = makeSolid({"superellipsoid", {0.1, 0.07, 0.16, 0.5, 1.2}, {}});
  const Transform world{Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix(),
                        Vec3(0.5, -1, 0.25)};
  for (int i = 0; i < 50; ++i) {
    const Vec3 local = random.uniform(0.05, 0.3) * randomDirection(random);
    const Vec3 position = world.point(local);
    VectorArray point(1), normal(1);
    point.x[0] = static_cast<float>(position.x());
    point.y[0] = static_cast<float>(position.y());
    point.z[0] = static_cast<float>(position.z());
    float distance_m = 0;
    evaluatePosed(solid, world, view(point, 0, 1), &distance_m, view(normal, 0, 1));
    const FieldSample expected = evaluateReference(solid, local);
    EXPECT_NEAR(static_cast<double>(distance_m), expected.distance_m, 2e-6);
    EXPECT_LT((at(normal, 0) - world.vector(expected.normal)).norm(), 1e-3);
  }
}

SolidDef randomSolid(Random& random) {
  const auto pick = [&](std::span<const ParameterInfo> infos) {
    std::vector<double> values;
    for (const ParameterInfo& info : infos) {
      const double share = random.uniform();
      const double corner = share < 0.5 ? info.min : info.max;
      values.push_back(random.uniform() < 0.3 ? corner : info.min + share * (info.max - info.min));
    }
    return values;
  };
  const Shape& shape = *shapes()[random.next() % shapes().size()];
  SolidDef def{std::string(shape.name()), pick(shape.parameters()), {}};
  for (std::size_t n = random.next() % 4; n > 0; --n) {
    const Deformation& type = *deformations()[random.next() % deformations().size()];
    def.deformations.push_back({std::string(type.name()), pick(type.parameters())});
  }
  return def;
}

double randomCoordinate(Random& random) {
  switch (random.next() % 6) {
    case 0:
      return 0.0;
    case 1:
      return random.uniform(-1e-30, 1e-30);
    case 2:
      return random.uniform(-1e30, 1e30);
    case 3:
      return random.uniform(-1e-4, 1e-4);
    default:
      return random.uniform(-2, 2);
  }
}

TEST(Kernels, AreFiniteWithUnitNormalsForEverySolidAndPoint) {
  Random random(35);
  for (int i = 0; i < 2000; ++i) {
    const Solid solid = makeSolid(randomSolid(random));
    for (int k = 0; k < 16; ++k) {
      const Vec3 p(randomCoordinate(random), randomCoordinate(random), randomCoordinate(random));
      const Sample sample = evaluateOne(solid, p);
      ASSERT_TRUE(std::isfinite(sample.distance_m)) << solid.shape().name() << p.transpose();
      ASSERT_NEAR(sample.normal.norm(), 1, 1e-4) << solid.shape().name() << p.transpose();
    }
    ASSERT_TRUE(solid.bounds().low.allFinite() && solid.bounds().high.allFinite());
  }
}

}  // namespace
}  // namespace fascia
