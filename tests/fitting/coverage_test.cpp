#include <gtest/gtest.h>

#include <fascia/fitting/containment.h>
#include <fascia/fitting/coverage.h>

#include "fitting/rigs.h"

namespace fascia {
namespace {

using namespace testing;

RiggedModel ball() {
  RiggedModel model;
  addJoint(model, "upper", -1, Vec3::Zero());
  addJoint(model, "lower", 0, Vec3::Zero());
  addEllipsoid(model, Vec3::Zero(), Vec3::Constant(0.5),
               [](const Vec3& p) { return onlyJoint(p.y() > 0 ? 0 : 1); });
  return model;
}

FittedSolid sphere(const Vec3& centre, double radius_m) {
  FittedSolid solid;
  solid.world.translation_m = centre;
  solid.half_m = Vec3::Constant(radius_m);
  return solid;
}

TEST(Coverage, CountsTheSkinThatHasFleshBeneath) {
  const RiggedModel model = ball();
  const RestSurface surface(model, {});
  FleshFit fit;
  fit.joints.resize(2);
  // Half a ball of flesh: the upper joint's skin lies over it, the lower one's mostly does not.
  const std::vector<FittedSolid> solids{sphere(Vec3(0, 0.3, 0), 0.15)};
  measureFit(surface, solids, std::vector<std::size_t>{0}, WornPieces(2), fit);
  // Rays to the middle that pass the ball: within asin(0.15 / 0.3) = 30° of its direction.
  const double cap = 1 - std::cos(radians(30));
  EXPECT_NEAR(fit.joints[0].coverage, cap, 0.04);
  EXPECT_EQ(fit.joints[1].coverage, 0);
  EXPECT_NEAR(fit.coverage, cap / 2, 0.02);
  EXPECT_EQ(fit.deepest_outside_m, 0);
}

TEST(Containment, MeasuresHowFarASolidComesOut) {
  const RiggedModel model = ball();
  const RestSurface surface(model, {});
  EXPECT_EQ(deepestOutside_m(surface, sphere(Vec3(0.1, 0, 0), 0.35)), 0);
  EXPECT_NEAR(deepestOutside_m(surface, sphere(Vec3(0.2, 0, 0), 0.35)), 0.05, 0.006);
}

TEST(Containment, ShrinksWhatIsTooLargeToTheMargin) {
  const RiggedModel model = ball();
  const RestSurface surface(model, {});
  FittedSolid solid = sphere(Vec3(0.2, 0, 0), 0.35);
  ASSERT_TRUE(shrinkInside(surface, nullptr, 0.01, solid));
  EXPECT_EQ(deepestOutside_m(surface, solid), 0);
  EXPECT_NEAR(solid.half_m.x(), 0.29, 0.01);
  FittedSolid outside = sphere(Vec3(0.9, 0, 0), 0.1);
  EXPECT_FALSE(shrinkInside(surface, nullptr, 0.01, outside));
}

// What lies in itself many times would take for ever at the usual number of samples.
TEST(RestSurface, OfACrowdHasFewerSamplesOfTheSameArea) {
  RiggedModel crowd;
  addJoint(crowd, "root", -1, Vec3::Zero());
  for (int i = 0; i < 100; ++i)
    addEllipsoid(crowd, Vec3(1e-3 * i, 0, 0), Vec3::Constant(0.5),
                 [](const Vec3&) { return onlyJoint(0); });
  const RestSurface many(crowd, {});
  const RestSurface one(ball(), {});
  EXPECT_GT(one.samples().size(), 2000u);
  EXPECT_LT(many.samples().size(), 600u);
  EXPECT_GT(many.samples().size(), 20u);  // the others are hidden
  double area_m2 = 0;
  for (const SurfaceSample& sample : many.samples()) area_m2 += sample.area_m2;
  EXPECT_NEAR(area_m2 / many.area_m2() + many.hiddenShare(), 1, 0.1);
}

}  // namespace
}  // namespace fascia
