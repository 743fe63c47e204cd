#include <fascia/base/random.h>
#include <fascia/math/rotation_vector.h>
#include <gtest/gtest.h>

namespace fascia {
namespace {

Vec3 randomVector(Random& random, double length) {
  const Vec3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  return length * v.normalized();
}

TEST(RotationVector, IsAxisTimesAngle) {
  Random random(3);
  for (const double angle : {0.0, 1e-9, 1e-5, 0.3, 2.0, 3.1}) {
    const Vec3 v = randomVector(random, angle);
    const Mat3 wanted = angle > 0 ? Eigen::AngleAxisd(angle, v.normalized()).toRotationMatrix()
                                  : Mat3(Mat3::Identity());
    EXPECT_LT((rotationOf(v).toRotationMatrix() - wanted).norm(), 1e-14) << angle;
    EXPECT_LT((vectorOf(rotationOf(v)) - v).norm(), 1e-14) << angle;
  }
}

TEST(RotationVector, GoesTheShorterWayRound) {
  const Quat q = rotationOf(Vec3(0, 0, 5));
  EXPECT_LT((vectorOf(q) - Vec3(0, 0, 5 - 2 * kPi)).norm(), 1e-14);
  EXPECT_LT((vectorOf(Quat(-q.coeffs())) - Vec3(0, 0, 5 - 2 * kPi)).norm(), 1e-14);
}

TEST(RotationVector, AngularVelocityIsTheDerivativeOfTheRotation) {
  Random random(4);
  for (const double angle : {1e-7, 1e-3, 0.5, 2.0, 4.0}) {
    const Vec3 v = randomVector(random, angle), rate = randomVector(random, 1.3);
    const double h = 1e-5;
    const Quat step = rotationOf(v + h * rate) * rotationOf(v - h * rate).conjugate();
    const Vec3 measured = vectorOf(step) / (2 * h);
    ASSERT_GT(measured.norm(), 0.1);
    EXPECT_LT((angularVelocityOf(v, rate) - measured).norm(), 1e-8) << angle;
    EXPECT_LT((vectorRateOf(v, angularVelocityOf(v, rate)) - rate).norm(), 1e-9) << angle;
  }
}

}  // namespace
}  // namespace fascia
