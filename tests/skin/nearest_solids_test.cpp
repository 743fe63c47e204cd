#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include <fascia/base/random.h>
#include <fascia/math/points.h>
#include <fascia/skin/point/attach.h>
#include <fascia/skin/point/nearest_solids.h>

#include "support/steep_field.h"
#include "test_fields.h"

namespace fascia {
namespace {

constexpr double kReach_m = 0.02;

test::RigidSolids chainOfSolids(std::size_t count) {
  test::RigidSolids field;
  for (std::size_t s = 0; s < count; ++s) {
    const Vec3 place(0.3 * static_cast<double>(s), 0.1 * static_cast<double>(s % 3), 0);
    if (s % 2 == 0)
      field.addSphere(place, 0.12);
    else
      field.add(test::superellipsoid(0.14, 0.09, 0.11, 0.6, 1.1), {Mat3::Identity(), place});
  }
  return field;
}

class CountingSolids final : public test::RigidSolids {
 public:
  explicit CountingSolids(const test::RigidSolids& solids) : RigidSolids(solids) {}
  void evaluate(SolidId id, ConstVectors points, float* distance_m, Vectors normal) const override {
    ++asked;
    RigidSolids::evaluate(id, points, distance_m, normal);
  }
  mutable int asked = 0;
};

// A block of points that drifts along the chain, by steps of `step_m`.
class Drift {
 public:
  explicit Drift(std::size_t count) : points_(count) {
    for (std::size_t i = 0; i < count; ++i)
      setPoint(points_, i,
               Vec3(0.01 * static_cast<double>(i), 0.25 + 0.05 * random_.uniform(), 0.1));
  }
  void advance(double step_m) {
    for (std::size_t i = 0; i < points_.size(); ++i)
      setPoint(points_, i, pointAt(points_, i) + step_m * Vec3(1, 0.3 * random_.uniform(), 0));
  }
  ConstVectors points() const { return view(points_, 0, points_.size()); }

 private:
  Random random_{7};
  VectorArray points_;
};

void expectToKnowAllOnTheWay(const DistanceField& field) {
  NearestSolids followed(field, kReach_m);
  Drift drift(20);
  for (int step = 0; step < 400; ++step) {
    followed.measure(drift.points());
    NearestSolids anew(field, kReach_m);
    anew.measure(drift.points());
    for (std::size_t i = 0; i < 20; ++i) {
      ASSERT_EQ(followed.solid(i), anew.solid(i)) << step << " " << i;
      ASSERT_EQ(followed.distance_m(i), anew.distance_m(i));
      ASSERT_EQ(pointAt(followed.normals(), i), pointAt(anew.normals(), i));
    }
    drift.advance(0.008);
  }
}

TEST(NearestSolids, SaysOnTheWayWhatAskingAllOfThemAnewSays) {
  expectToKnowAllOnTheWay(chainOfSolids(12));
  expectToKnowAllOnTheWay(test::Steep<test::RigidSolids>(chainOfSolids(12)));
}

TEST(NearestSolids, AsksFewOfManySolids) {
  const CountingSolids field(chainOfSolids(60));
  NearestSolids nearest(field, kReach_m);
  Drift drift(20);
  constexpr int kSteps = 200;
  for (int step = 0; step < kSteps; ++step) {
    nearest.measure(drift.points());
    drift.advance(0.001);
  }
  EXPECT_LT(field.asked, kSteps * 60 / 5);
}

TEST(NearestSolids, TellsWhetherAnyPointIsNearer) {
  const test::RigidSolids field = test::RigidSolids().addSphere(Vec3::Zero(), 1);
  NearestSolids nearest(field, kReach_m);
  VectorArray points(2);
  setPoint(points, 0, Vec3(1.5, 0, 0));
  setPoint(points, 1, Vec3(3, 0, 0));
  nearest.measure(view(std::as_const(points), 0, 2));
  EXPECT_FALSE(nearest.anyNearer(0.5));
  EXPECT_TRUE(nearest.anyNearer(std::nextafter(0.5, 1.0)));
}

TEST(Attach, FollowsTheInwardNormalToTheSurface) {
  const test::RigidSolids field = test::RigidSolids().addSphere(Vec3::Zero(), 0.5);
  VectorArray points(9), normals(9);
  // Seen from (0.2, 0, 0.6) along −z the sphere begins where x = 0.2; along x it is not met at all.
  for (std::size_t k = 0; k < points.size(); ++k) {
    setPoint(points, k, Vec3(0.2, 0, 0.6));
    setPoint(normals, k, k == 1 ? Vec3::UnitX() : Vec3::UnitZ());
  }
  // All points but the first, the last of them first.
  const PointRun runs[] = {{5, 0, 4}, {1, 4, 4}};
  const std::vector<Attachment> found = attachAlongNormals(field, runs, points, normals, 0.01);
  ASSERT_EQ(found.size(), 8u);
  const Vec3 nearest = 0.5 * Vec3(0.2, 0, 0.6).normalized(), met(0.2, 0, std::sqrt(0.21));
  EXPECT_LT((found[4].place_m - nearest).norm(), 1e-6);
  for (const std::size_t p : {0, 1, 2, 3, 5, 6, 7})
    EXPECT_LT((found[p].place_m - met).norm(), 2e-4);
}

}  // namespace
}  // namespace fascia
