#include <gtest/gtest.h>

#include <fascia/base/error.h>
#include <fascia/math/finite_difference.h>

#include "bodies.h"

namespace fascia {
namespace {

TEST(Basis, GradientsAreThoseOfTheValues) {
  for (const BasisPtr& basis : test::allBases()) {
    Random random(5);
    for (int repeat = 0; repeat < 5; ++repeat) {
      Vec3 X = test::kBarSize_m.cwiseProduct(
          Vec3(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)));
      if (basis->dimension() == 2) X.z() = 0;
      Eigen::MatrixXd dp(basis->size(), 3);
      basis->gradients(X, dp);
      const Eigen::MatrixXd numeric = numericJacobian(
          [&](const Eigen::VectorXd& at) {
            Eigen::VectorXd p(basis->size());
            basis->values(at, p);
            return p;
          },
          X, 1e-6);
      const int d = basis->dimension();
      EXPECT_LT(derivativeMismatch(dp.leftCols(d), numeric.leftCols(d)), 1e-7)
          << basis->name() << d;
    }
  }
}

TEST(Basis, PolynomialsOfOneOrderAreAsManyAsTheBinomialSays) {
  const Box box = test::boxOf(Vec3::Ones());
  EXPECT_EQ(makePolynomialBasis(3, 2, box)->size(), 10);  // the paper's p, §2.2
  EXPECT_EQ(makePolynomialBasis(3, 5, box)->size(), 56);
  EXPECT_EQ(makePolynomialBasis(2, 4, box)->size(), 15);
}

TEST(Basis, BernsteinPolynomialsSumToOneAndInterpolateTheCorners) {
  const Box box = test::boxOf(test::kBarSize_m);
  const BasisPtr basis = makeBernsteinBasis(3, {4, 2, 3}, box);
  Eigen::VectorXd p(basis->size());
  basis->values(Vec3(0.11, 0.02, -0.04), p);
  EXPECT_NEAR(p.sum(), 1, 1e-14);
  EXPECT_GT(p.minCoeff(), 0);
  basis->values(box.low, p);
  EXPECT_NEAR(p[0], 1, 1e-14);
  basis->values(box.high, p);
  EXPECT_NEAR(p[basis->size() - 1], 1, 1e-14);
}

TEST(Basis, SkinningModesOfABarAreCosines) {
  // Laplace's eigenfunctions with free ends: cos(π j x/L), exact at the nodes of a regular grid.
  const BasisPtr basis = makeSkinningModesBasis(2, 3, test::boxOf({0.4, 0.05, 0}), 0.05,
                                                [](const Vec3&) { return true; });
  Eigen::VectorXd p(basis->size());
  for (int i = 0; i <= 8; ++i) {
    basis->values(Vec3(-0.2 + 0.05 * i, 0.0, 0), p);
    for (int mode = 1; mode <= 2; ++mode)
      EXPECT_NEAR(std::abs(p[3 * mode + 2]), std::abs(std::cos(kPi * mode * i / 8.0)), 1e-9);
  }
}

TEST(Basis, SkinningModesFollowTheBodyAndNotTheSpaceAroundIt) {
  // Two arms beside each other, joined at one end: close in space, far apart in the body.
  const auto horseshoe = [](const Vec3& X) { return X.x() < 0.1 || std::abs(X.y()) > 0.1; };
  const Box box{Vec3(0, -0.2, 0), Vec3(0.8, 0.2, 0)};
  const BasisPtr basis = makeSkinningModesBasis(2, 2, box, 0.05, horseshoe);
  Eigen::VectorXd upper(basis->size()), lower(basis->size());
  basis->values(Vec3(0.8, 0.15, 0), upper);
  basis->values(Vec3(0.8, -0.15, 0), lower);
  EXPECT_NEAR(std::abs(upper[5] - lower[5]), 2, 0.02);  // from one end to the other
}

TEST(Basis, RefusesWhatItCannotBe) {
  const Box box = test::boxOf(Vec3::Ones());
  EXPECT_THROW(makeAffineBasis(4), Error);
  EXPECT_THROW(makePolynomialBasis(3, 0, box), Error);
  EXPECT_THROW(makeBernsteinBasis(3, {1, 0, 1}, box), Error);
  EXPECT_THROW(makeSkinningModesBasis(3, 4, box, 0.5, [](const Vec3&) { return false; }), Error);
}

}  // namespace
}  // namespace fascia
