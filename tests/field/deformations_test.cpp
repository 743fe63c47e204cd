#include <gtest/gtest.h>

#include "solids.h"

namespace fascia {
namespace {

constexpr double kZHalf_m = 0.2;

// Amounts over the whole range, held to where the map is one-to-one for the points below.
std::vector<double> amounts(const Deformation& deformation) {
  const ParameterInfo& info = deformation.parameters().front();
  std::vector<double> all;
  for (double share : {0.0, 0.13, 0.5 + 1e-9, 0.5 + 1e-5, 0.7, 1.0}) {
    const double wanted = info.min + share * (info.max - info.min);
    const Box box{Vec3(-0.1, -0.1, -0.3), Vec3(0.1, 0.1, 0.3)};
    all.push_back(deformation.invertibleAmount(std::span(&wanted, 1), kZHalf_m, box));
  }
  return all;
}

// Within the deformed interval and beyond its ends.
Vec3 randomPoint(Random& random) {
  return {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.3, 0.3)};
}

TEST(Deformation, InverseUndoesForward) {
  Random random(1);
  for (const Deformation* deformation : deformations()) {
    for (const double amount : amounts(*deformation)) {
      const std::span p(&amount, 1);
      for (int i = 0; i < 200; ++i) {
        const Vec3 x = randomPoint(random);
        const Vec3 back = deformation->inverse(p, kZHalf_m, deformation->forward(p, kZHalf_m, x));
        EXPECT_LT((back - x).norm(), 1e-12) << deformation->name() << " " << amount;
      }
    }
  }
}

TEST(Deformation, StandardAmountIsTheIdentity) {
  Random random(2);
  for (const Deformation* deformation : deformations()) {
    const double amount = deformation->parameters().front().standard;
    const Vec3 x = randomPoint(random);
    EXPECT_EQ(deformation->forward(std::span(&amount, 1), kZHalf_m, x), x);
  }
}

TEST(Deformation, JacobianEqualsFiniteDifferences) {
  Random random(3);
  constexpr double kStep_m = 1e-6;
  for (const Deformation* deformation : deformations()) {
    double largest = 0;
    for (const double amount : amounts(*deformation)) {
      const std::span p(&amount, 1);
      for (int i = 0; i < 100; ++i) {
        const Vec3 x = randomPoint(random);
        if (std::abs(std::abs(x.z()) - kZHalf_m) < 2 * kStep_m) continue;  // the kink at the ends
        const Mat3 jacobian = deformation->jacobian(p, kZHalf_m, x);
        Mat3 difference;
        for (int axis = 0; axis < 3; ++axis) {
          const Vec3 h = kStep_m * Vec3::Unit(axis);
          difference.col(axis) = (deformation->forward(p, kZHalf_m, x + h) -
                                  deformation->forward(p, kZHalf_m, x - h)) /
                                 (2 * kStep_m);
        }
        EXPECT_LT((jacobian - difference).norm(), 1e-7) << deformation->name() << " " << amount;
        largest = std::max(largest, (jacobian - Mat3::Identity()).norm());
      }
    }
    EXPECT_GT(largest, 0.5) << deformation->name();
  }
}

TEST(Bend, KeepsTheLengthOfItsCentreline) {
  const double angle_rad = 1.3;
  const Deformation& bend = *findDeformation("bend");
  double length_m = 0;
  Vec3 last = bend.forward(std::span(&angle_rad, 1), kZHalf_m, {0, 0, -kZHalf_m});
  for (int i = 1; i <= 1000; ++i) {
    const Vec3 next =
        bend.forward(std::span(&angle_rad, 1), kZHalf_m, {0, 0, kZHalf_m * (2.0 * i / 1000 - 1)});
    length_m += (next - last).norm();
    last = next;
  }
  EXPECT_NEAR(length_m, 2 * kZHalf_m, 1e-6);
}

// The flank of a tapered box is a plane: distances to it are exact however far away.
TEST(Taper, MeasuresDistancesToFlanksFromAfar) {
  const double half = 0.1, slope = 0.75 * half / 0.2;  // of the flank, dX/dz
  const Solid solid =
      makeSolid({"superellipsoid", {half, 0.1, 0.2, 0.1, 0.1}, {{"taper", {0.75}}}});
  for (const double away : {0.05, 0.2, 0.5}) {
    const Vec3 foot(half, 0, 0), normal = Vec3(1, 0, -slope).normalized();
    const Vec3 p = foot + away * normal;
    if (std::abs(p.z()) > 0.2) continue;
    const auto x = static_cast<float>(p.x()), y = 0.f, z = static_cast<float>(p.z());
    float distance, nx, ny, nz;
    solid.evaluate({&x, &y, &z, 1}, &distance, {&nx, &ny, &nz, 1});
    EXPECT_NEAR(distance, away, 0.02 * away);
    EXPECT_GT(Vec3(nx, ny, nz).dot(normal), 0.999);
  }
}

TEST(Bend, OfAStoutSolidStopsBeforeItFolds) {
  const Solid solid = makeSolid({"superellipsoid", {0.3, 0.1, 0.1}, {{"bend", {3.0}}}});
  for (const auto& p : solid.tessellate(48).positions) {
    const Vec3 x = solid.shapeFromDeformed(p.cast<double>());
    EXPECT_GT(solid.deformationJacobian(x).determinant(), 0.05);
  }
}

}  // namespace
}  // namespace fascia
