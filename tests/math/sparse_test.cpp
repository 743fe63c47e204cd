#include <fascia/math/sparse.h>

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include <Eigen/Dense>

#include <fascia/base/random.h>

namespace fascia {
namespace {

SparseMatrix randomMatrix(int n, bool symmetric, std::uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, random.uniform(4, 6));
    const int j = (7 * i + 3) % n;
    const double x = random.uniform(-1, 1);
    entries.emplace_back(i, j, x);
    entries.emplace_back(j, i, symmetric ? x : random.uniform(-1, 1));
  }
  SparseMatrix a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

Eigen::VectorXd ramp(int n) {
  return Eigen::VectorXd::LinSpaced(n, -1, 2);
}

TEST(SparseFactorization, SolvesLikeTheDenseOne) {
  for (const MatrixKind kind : {MatrixKind::symmetric, MatrixKind::general}) {
    const SparseMatrix a = randomMatrix(40, kind == MatrixKind::symmetric, 5);
    Eigen::VectorXd x;
    ASSERT_TRUE(solveSparse(a, ramp(40), x, kind));
    const Eigen::VectorXd dense = Eigen::MatrixXd(a).fullPivLu().solve(ramp(40));
    EXPECT_LT((x - dense).norm(), 1e-12 * dense.norm());
  }
}

TEST(SparseFactorization, AnalysesAPatternOnceAndAChangedOneAgain) {
  SparseFactorization factorization(MatrixKind::symmetric);
  Eigen::VectorXd x;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const SparseMatrix a = randomMatrix(30, true, seed);
    ASSERT_TRUE(factorization.factorize(a));
    ASSERT_TRUE(factorization.solve(ramp(30), x));
    EXPECT_LT((a * x - ramp(30)).norm(), 1e-12);
  }
  EXPECT_EQ(factorization.symbolicCount(), 1);

  SparseMatrix wider = randomMatrix(30, true, 4);
  wider.coeffRef(29, 0) = wider.coeffRef(0, 29) = 0.5;  // uncompressed now
  ASSERT_TRUE(factorization.factorize(wider));
  ASSERT_TRUE(factorization.solve(ramp(30), x));
  EXPECT_LT((wider * x - ramp(30)).norm(), 1e-12);
  EXPECT_EQ(factorization.symbolicCount(), 2);
}

TEST(SparseFactorization, TakesSymmetricMatricesWithoutUsablePivots) {
  SparseMatrix swap(2, 2);
  swap.insert(0, 1) = swap.insert(1, 0) = 1;
  Eigen::VectorXd x;
  ASSERT_TRUE(solveSparse(swap, Eigen::Vector2d(3, 4), x, MatrixKind::symmetric));
  EXPECT_TRUE(x.isApprox(Eigen::Vector2d(4, 3)));
}

TEST(SparseFactorization, RefusesSingularNonFiniteAndOblongMatrices) {
  SparseMatrix singular(2, 2), nan(1, 1), oblong(2, 3);
  singular.insert(0, 0) = 1;
  singular.insert(1, 1) = 0;
  nan.insert(0, 0) = std::numeric_limits<double>::quiet_NaN();
  for (const MatrixKind kind : {MatrixKind::symmetric, MatrixKind::general}) {
    SparseFactorization factorization(kind);
    Eigen::VectorXd x = ramp(2);
    EXPECT_FALSE(factorization.factorize(singular) && factorization.solve(ramp(2), x));
    EXPECT_FALSE(factorization.factorize(nan));
    EXPECT_FALSE(factorization.factorize(oblong));
    EXPECT_FALSE(factorization.solve(ramp(2), x));
    EXPECT_EQ(x, ramp(2)) << "a failed solve wrote its result";
  }
}

TEST(SparseFactorization, RefusesARightSideOfAnotherSize) {
  SparseFactorization factorization(MatrixKind::general);
  ASSERT_TRUE(factorization.factorize(randomMatrix(5, false, 1)));
  Eigen::VectorXd x;
  EXPECT_FALSE(factorization.solve(ramp(4), x));
}

}  // namespace
}  // namespace fascia
