#include <gtest/gtest.h>

#include <fascia/fitting/solid_fitting.h>

namespace fascia {
namespace {

// Points at a constant distance outside of a solid's surface.
SolidTarget targetAround(const FittedSolid& solid, double fat_m) {
  SolidTarget target;
  target.size_m = solid.half_m.minCoeff();
  target.prior = 0;
  const TriangleMesh mesh = solid.solid().tessellate(24);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3 p = solid.world.point(mesh.positions[i].cast<double>());
    const Vec3 n = solid.world.vector(mesh.normals[i].cast<double>());
    target.reach.push_back({p + fat_m * n, fat_m, 1});
  }
  return target;
}

FittedSolid knownSolid() {
  FittedSolid solid;
  solid.world.rotation = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  solid.world.translation_m = {0.4, 1.2, -0.3};
  solid.half_m = {0.05, 0.07, 0.2};
  solid.exponent_e1 = 0.7;
  solid.exponent_e2 = 0.9;
  solid.taper = 0.3;
  solid.bend_rad = 0.4;
  return solid;
}

TEST(SolidFitting, RecoversAKnownSolidFromInsetPoints) {
  const FittedSolid known = knownSolid();
  const SolidTarget target = targetAround(known, 0.01);
  FittedSolid guess;
  guess.world = known.world;
  guess.world.translation_m += Vec3(0.02, -0.015, 0.01);
  guess.world.rotation =
      known.world.rotation * Eigen::AngleAxisd(0.15, Vec3::UnitY()).toRotationMatrix();
  guess.half_m = {0.06, 0.06, 0.15};
  ASSERT_GT(residualRms_m(target, guess), 0.01);
  const FittedSolid fitted = fitSolid(target, guess);
  EXPECT_LT(residualRms_m(target, fitted), 5e-4);
  EXPECT_LT((fitted.half_m - known.half_m).cwiseAbs().maxCoeff(), 0.003);
  EXPECT_LT((fitted.world.translation_m - known.world.translation_m).norm(), 0.004);
  EXPECT_NEAR(fitted.exponent_e1, known.exponent_e1, 0.05);
  EXPECT_NEAR(fitted.taper, known.taper, 0.03);
  EXPECT_NEAR(fitted.bend_rad, known.bend_rad, 0.08);
}

TEST(SolidFitting, StaysUnderItsBounds) {
  const FittedSolid known = knownSolid();
  SolidTarget target = targetAround(known, 0.01);
  const Vec3 side = known.world.rotation.col(0);
  // A wall within reach on one side.
  for (double t = -0.2; t <= 0.2; t += 0.02)
    target.bounds.push_back(
        {known.world.translation_m + 0.03 * side + t * known.world.rotation.col(2), 0.002, 20});
  const FittedSolid fitted = fitSolid(target, known);
  std::vector<Vec3> wall;
  for (const auto& bound : target.bounds) wall.push_back(bound.position_m);
  std::vector<double> before, after;
  distances(known, wall, before);
  distances(fitted, wall, after);
  EXPECT_LT(*std::min_element(before.begin(), before.end()), -0.01);
  EXPECT_GT(*std::min_element(after.begin(), after.end()), -0.003);
}

TEST(SolidFitting, KeepsASymmetricPartInItsPlane) {
  FittedSolid known = knownSolid();
  known.world.rotation = Mat3::Identity();
  SolidTarget target = targetAround(known, 0.01);
  target.symmetric = true;
  FittedSolid guess = known;
  guess.world.rotation = Eigen::AngleAxisd(0.2, Vec3::UnitY()).toRotationMatrix();
  guess.half_m *= 0.8;
  const FittedSolid fitted = fitSolid(target, guess);
  EXPECT_EQ(fitted.world.translation_m.y(), known.world.translation_m.y());
  EXPECT_EQ(fitted.world.rotation.col(1), Vec3::UnitY());
  EXPECT_LT(residualRms_m(target, fitted), 1e-3);
}

TEST(FittedSolid, MirrorImageIsAsFarFromMirroredPoints) {
  const FittedSolid solid = knownSolid();
  const MirrorPlane plane{0, 0.1};
  std::vector<Vec3> points, images;
  for (int i = 0; i < 20; ++i) {
    points.push_back(solid.world.translation_m +
                     0.1 * Vec3(std::sin(i), std::cos(2 * i), std::sin(3 * i)));
    images.push_back(plane.point(points.back()));
  }
  std::vector<double> a, b;
  distances(solid, points, a);
  distances(solid.mirrored(plane), images, b);
  EXPECT_NEAR(solid.mirrored(plane).world.rotation.determinant(), 1, 1e-12);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-6);
}

}  // namespace
}  // namespace fascia
