#include <gtest/gtest.h>

#include <fascia/base/random.h>
#include <fascia/flesh/flesh.h>
#include <fascia/skeleton/euler.h>
#include <fascia/world/placed_field.h>

namespace fascia {
namespace {

// A ball on a joint, and the same ball where the placed field should have it.
class PlacedBall : public testing::Test {
 protected:
  PlacedBall() {
    Diagnostics diagnostics;
    SkeletonDef skeleton;
    skeleton.joints.emplace_back().name = "root";
    skeleton.joints.back().offset_m = Vec3(0.3, 1, 0);
    const Skeleton built(skeleton, "", diagnostics);
    FleshDef flesh;
    flesh.solids.emplace_back().name = "ball";
    flesh.solids.back().joint = "root";
    flesh.solids.back().solid.parameters = {kRadius_m};
    const Flesh bound(flesh, built, "", diagnostics);
    PosedSkeleton posed;
    built.pose(built.restPosture(), posed);
    bound.pose(built.restPosture(), posed, {}, inner_);
  }
  static constexpr double kRadius_m = 0.2;
  const Transform place_{rotationZyx({0.2, 1.1, -0.4}), Vec3(2, -1, 0.5)};
  PosedFlesh inner_;
  PlacedField placed_{inner_, place_};
  const SolidId ball_{0};
};

TEST_F(PlacedBall, DistancesAndNormalsAreThoseOfTheBallWhereItIsPlaced) {
  const Vec3 center = place_.point(Vec3(0.3, 1, 0));
  constexpr std::size_t kCount = 150;  // more than one batch
  VectorArray points(kCount), normals(kCount);
  FloatArray distance(kCount);
  Random random(4);
  for (std::size_t i = 0; i < kCount; ++i)
    for (FloatArray* a : {&points.x, &points.y, &points.z})
      (*a)[i] = static_cast<float>(random.uniform(-3, 3));
  placed_.evaluate(ball_, view(points, 0, kCount), distance.data(), view(normals, 0, kCount));
  for (std::size_t i = 0; i < kCount; ++i) {
    const Vec3 off = Vec3(points.x[i], points.y[i], points.z[i]) - center;
    EXPECT_NEAR(distance[i], off.norm() - kRadius_m, 1e-5);
    EXPECT_NEAR((Vec3(normals.x[i], normals.y[i], normals.z[i]) - off.normalized()).norm(), 0,
                1e-5);
  }
}

TEST_F(PlacedBall, BoundsHoldTheBallAndMaterialComesBack) {
  const Vec3 center = place_.point(Vec3(0.3, 1, 0));
  const Box box = placed_.bounds(ball_);
  EXPECT_TRUE((box.low.array() <= center.array() - kRadius_m + 1e-9).all());
  EXPECT_TRUE((box.high.array() >= center.array() + kRadius_m - 1e-9).all());
  const Vec3 x(1.9, -0.7, 0.4);
  EXPECT_NEAR((placed_.worldFromMaterial(ball_, placed_.materialFromWorld(ball_, x)) - x).norm(), 0,
              1e-9);
  EXPECT_NEAR((placed_.frame(ball_).translation_m - center).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace fascia
