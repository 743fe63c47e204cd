#include <fascia/baking/rigid_fit.h>

#include <gtest/gtest.h>

#include <Eigen/SVD>

#include <fascia/base/random.h>

namespace fascia {
namespace {

Mat3 randomMatrix(Random& random) {
  Mat3 m;
  for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = random.uniform(-1.0, 1.0);
  return m;
}

Mat3 randomRotation(Random& random) {
  const auto number = [&] { return random.uniform(-1.0, 1.0); };
  const double w = number(), x = number(), y = number(), z = number();
  return Quat(w, x, y, z).normalized().toRotationMatrix();
}

// tr(R · correlation) of the best rotation: singular values, the smallest with the sign of the
// determinant.
double mostTrace(const Mat3& correlation) {
  const Eigen::JacobiSVD<Mat3> svd(correlation);
  const Vec3 s = svd.singularValues();
  return s[0] + s[1] + (correlation.determinant() < 0 ? -s[2] : s[2]);
}

TEST(BestRotation, IsTheBestFromAnyStart) {
  Random random(7);
  for (int k = 0; k < 2000; ++k) {
    const Mat3 correlation = randomMatrix(random);
    const Mat3 start = randomRotation(random);
    const Mat3 turn = bestRotation(correlation, start);
    EXPECT_NEAR((turn * correlation).trace(), mostTrace(correlation), 1e-9) << k;
    EXPECT_LT((turn.transpose() * turn - Mat3::Identity()).norm(), 1e-12) << k;
    EXPECT_NEAR(turn.determinant(), 1, 1e-12) << k;
  }
}

TEST(BestRotation, OfFlatAndStraightPointsIsARotation) {
  Random random(8);
  for (int k = 0; k < 200; ++k) {
    Mat3 correlation = randomMatrix(random);
    correlation.col(2).setZero();
    if (k % 2 == 1) correlation.col(1).setZero();
    if (k % 20 == 0) correlation.setZero();
    const Mat3 turn = bestRotation(correlation, randomRotation(random));
    EXPECT_NEAR((turn * correlation).trace(), mostTrace(correlation), 1e-9) << k;
    EXPECT_NEAR(turn.determinant(), 1, 1e-9) << k;
  }
}

// Points that were moved rigidly: the motion is found to the last digits, at any size.
TEST(RigidFit, FindsTheMotionOfRigidPoints) {
  Random random(9);
  for (const double size : {1e-3, 1.0, 1e3}) {
    const Transform moved{randomRotation(random), size * Vec3(1, -2, 3)};
    const Vec3 origin = size * Vec3(5, 0, 1);
    RigidSums sums;
    for (int i = 0; i < 12; ++i) {
      const Vec3 q = size * Vec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                                 random.uniform(-1.0, 1.0));
      const double s = random.uniform(0.2, 1.0);
      const Vec3 x = s * moved.point(origin + q);
      sums.mass += s * s;
      sums.spread += s * s * q.squaredNorm();
      sums.point += s * s * q;
      sums.target += s * x;
      sums.correlation += s * q * x.transpose();
    }
    const Transform found = fitRigidly(sums, origin, {});
    EXPECT_LT((found.rotation - moved.rotation).norm(), 1e-7) << size;
    EXPECT_LT((found.point(origin) - moved.point(origin)).norm(), 1e-7 * size) << size;
  }
}

}  // namespace
}  // namespace fascia
