#include <gtest/gtest.h>

#include <algorithm>

#include <fascia/field/reference.h>

#include "solids.h"

namespace fascia {
namespace {

struct Closest {
  double distance_m;
  Vec3 normal;
};

// True signed distance to a convex solid by search: the largest distance to any tangent plane.
// A grid over directions, then ever finer pattern search around its best.
class TrueDistance {
 public:
  explicit TrueDistance(const Solid& solid) : solid_(solid) {}

  double at(const Vec3& p) const {
    double best = -1e9, bestLatitude = 0, bestLongitude = 0;
    constexpr int kGrid = 48;
    for (int i = 0; i <= kGrid; ++i) {
      for (int j = 0; j <= kGrid; ++j) {
        const double latitude = 0.5 * kPi * i / kGrid, longitude = 0.5 * kPi * j / kGrid;
        const double d = planeDistance(latitude, longitude, p);
        if (d > best) best = d, bestLatitude = latitude, bestLongitude = longitude;
      }
    }
    for (double step = 0.5 * kPi / kGrid; step > 1e-9;) {
      bool improved = false;
      for (int i = -1; i <= 1; ++i) {
        for (int j = -1; j <= 1; ++j) {
          const double latitude = std::clamp(bestLatitude + i * step, 0.0, 0.5 * kPi);
          const double longitude = std::clamp(bestLongitude + j * step, 0.0, 0.5 * kPi);
          const double d = planeDistance(latitude, longitude, p);
          if (d > best) {
            best = d, bestLatitude = latitude, bestLongitude = longitude, improved = true;
          }
        }
      }
      if (!improved) step *= 0.5;
    }
    return best;
  }

 private:
  // All the shapes are symmetric: the octant of p is enough.
  double planeDistance(double latitude, double longitude, const Vec3& p) const {
    const Vec3 material(std::cos(latitude) * std::cos(longitude),
                        std::cos(latitude) * std::sin(longitude), std::sin(latitude));
    const Vec3 q = solid_.localFromMaterial(material);
    return evaluateReference(solid_, q).normal.dot(p.cwiseAbs() - q);
  }
  const Solid& solid_;
};

// Largest error relative to the largest |d|, and the largest excess over the true distance.
struct Errors {
  double relative = 0, excess_m = 0;
};

Errors distanceErrors(const SolidDef& def, double share, Random& random) {
  const Solid solid = makeSolid(def);
  const double limit_m = share * solid.halfExtents_m().minCoeff();
  const TrueDistance truth(solid);
  Errors errors;
  for (int i = 0; i < 8; ++i) {
    const Vec3 q = solid.localFromMaterial(randomDirection(random));
    const Vec3 n = evaluateReference(solid, q).normal;
    const Vec3 p = q + random.uniform(-limit_m, limit_m) * n;
    const double error_m = evaluateOne(solid, p).distance_m - truth.at(p);
    errors.relative = std::max(errors.relative, std::abs(error_m) / limit_m);
    errors.excess_m = std::max(errors.excess_m, error_m);
  }
  return errors;
}

Errors worstSuperellipsoid(double least, double most, double share) {
  Random random(21);
  Errors worst;
  for (int i = 0; i < 25; ++i) {
    const Errors errors = distanceErrors(randomSuperellipsoid(random, least, most), share, random);
    worst.relative = std::max(worst.relative, errors.relative);
    worst.excess_m = std::max(worst.excess_m, errors.excess_m);
  }
  return worst;
}

// The bounds that solid.h states.
TEST(Distance, OfSphereAndCapsuleIsExact) {
  Random random(20);
  for (int i = 0; i < 200; ++i) {
    const Vec3 p = random.uniform(0, 0.4) * randomDirection(random);
    const double onAxis = std::clamp(p.z(), -0.15, 0.15);
    EXPECT_NEAR(evaluateOne(makeSolid({"sphere", {0.1}, {}}), p).distance_m, p.norm() - 0.1, 1e-7);
    EXPECT_NEAR(evaluateOne(makeSolid({"capsule", {0.1, 0.15}, {}}), p).distance_m,
                (p - Vec3(0, 0, onAxis)).norm() - 0.1, 1e-7);
  }
}

TEST(Distance, OfEllipsoidsIsWithinItsBound) {
  const Errors near = worstSuperellipsoid(1, 1, 0.1), far = worstSuperellipsoid(1, 1, 0.25);
  EXPECT_LT(near.relative, 2e-4);
  EXPECT_LT(far.relative, 0.06);
  EXPECT_LT(far.excess_m, 2e-7);
}

TEST(Distance, OfRoundSuperellipsoidsIsWithinItsBound) {
  const Errors near = worstSuperellipsoid(0.5, 1.25, 0.1);
  const Errors far = worstSuperellipsoid(0.5, 1.25, 0.25);
  EXPECT_LT(near.relative, 0.01);
  EXPECT_LT(far.relative, 0.06);
  EXPECT_LT(far.excess_m, 2e-7);  // never more than the true distance
}

TEST(Distance, OfSharpSuperellipsoidsIsWithinItsBound) {
  const Errors near = worstSuperellipsoid(0.2, 2, 0.1), far = worstSuperellipsoid(0.2, 2, 0.25);
  EXPECT_LT(near.relative, 0.1);
  EXPECT_LT(far.relative, 0.2);
  EXPECT_LT(far.excess_m, 2e-7);
}

// r <- r + λ∇g (Turner & Gobbetti 1998, eq. 13a).
TEST(Distance, MovesAPenetratingPointToTheSurface) {
  Random random(22);
  for (const SolidDef& def : assortedSolids()) {
    const Solid solid = makeSolid(def);
    const double depth_m = 0.05 * solid.halfExtents_m().minCoeff();
    double largest_m = 0;
    for (int i = 0; i < 100; ++i) {
      const Vec3 q = solid.localFromMaterial(randomDirection(random));
      const Vec3 p = q - depth_m * evaluateReference(solid, q).normal;
      const Sample sample = evaluateOne(solid, p);
      EXPECT_LT(sample.distance_m, 0);
      const Vec3 moved = p - sample.distance_m * sample.normal;
      const double left_m = evaluateOne(solid, moved).distance_m;
      if (!solid.deformed()) {
        EXPECT_GT(left_m, -1e-6) << def.shape;
      }
      largest_m = std::max(largest_m, std::abs(left_m));
    }
    EXPECT_LT(largest_m, 0.15 * depth_m) << def.shape << " " << solid.deformed();
  }
}

TEST(Normal, IsTheGradientOfTheDistanceOnTheSurface) {
  Random random(23);
  constexpr double kStep_m = 1e-7;  // far below the radius of the sharpest rim
  for (const SolidDef& def : assortedSolids()) {
    const Solid solid = makeSolid(def);
    for (int i = 0; i < 50; ++i) {
      const Vec3 q = solid.localFromMaterial(randomDirection(random));
      Vec3 gradient;
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 h = kStep_m * Vec3::Unit(axis);
        gradient[axis] = (evaluateReference(solid, q + h).distance_m -
                          evaluateReference(solid, q - h).distance_m) /
                         (2 * kStep_m);
      }
      EXPECT_NEAR(gradient.norm(), 1, 2e-3) << def.shape;
      EXPECT_LT((gradient - evaluateReference(solid, q).normal).norm(), 2e-3) << def.shape;
    }
  }
}

}  // namespace
}  // namespace fascia
