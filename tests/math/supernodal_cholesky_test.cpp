#include <fascia/math/supernodal_cholesky.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <fascia/base/parallel.h>
#include <fascia/base/random.h>
#include <fascia/math/cholesky/nested_dissection.h>
#include <fascia/math/cholesky/supernodes.h>

namespace fascia {
namespace {

using Floats = std::vector<float>;
using Triplets = std::vector<Eigen::Triplet<double>>;

SparseMatrix matrix(int n, const Triplets& entries) {
  SparseMatrix a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

// Laplacian of a torus of triangles, its nodes in a random order.
Triplets torusLaplacian(int across, int around, int firstNode, std::uint64_t seed) {
  Random random(seed);
  const int n = across * around;
  std::vector<int> number(static_cast<std::size_t>(n));
  std::iota(number.begin(), number.end(), firstNode);
  for (int i = n - 1; i > 0; --i)
    std::swap(number[static_cast<std::size_t>(i)],
              number[static_cast<std::size_t>(random.uniform(0, i + 0.999))]);
  Triplets entries;
  const auto node = [&](int i, int j) {
    return number[static_cast<std::size_t>((i % across) * around + j % around)];
  };
  for (int i = 0; i < across; ++i)
    for (int j = 0; j < around; ++j)
      for (const int to : {node(i + 1, j), node(i, j + 1), node(i + 1, j + 1)}) {
        const double weight = random.uniform(0.1, 1);
        const int from = node(i, j);
        entries.emplace_back(from, to, -weight);
        entries.emplace_back(to, from, -weight);
        entries.emplace_back(from, from, weight);
        entries.emplace_back(to, to, weight);
      }
  return entries;
}

// As a thin shell: bending, and springs to where it rests.
SparseMatrix shell(const SparseMatrix& laplacian, double springs) {
  SparseMatrix identity(laplacian.rows(), laplacian.cols());
  identity.setIdentity();
  return SparseMatrix(laplacian * laplacian) + springs * identity;
}

SparseMatrix torusShell(int across, int around) {
  return shell(matrix(across * around, torusLaplacian(across, around, 0, 7)), 0.1);
}

Floats randomFloats(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  Floats result(n);
  for (float& x : result) x = static_cast<float>(random.uniform(-1, 1));
  return result;
}

Eigen::VectorXd asVector(const Floats& x) {
  return Eigen::Map<const Eigen::VectorXf>(x.data(), static_cast<Eigen::Index>(x.size()))
      .cast<double>();
}

// Largest error of solving for one and three right sides, relative to Eigen's solution in double.
double errorBesideEigen(const SparseMatrix& a) {
  SupernodalCholesky factor;
  SupernodalCholesky::Scratch scratch;
  if (!factor.factorize(a)) return HUGE_VAL;
  const Eigen::SimplicialLDLT<SparseMatrix> eigen(a);
  Floats sides[4];
  Eigen::VectorXd expected[4];
  for (std::size_t s = 0; s < 4; ++s) {
    sides[s] = randomFloats(factor.size(), s + 1);
    expected[s] = eigen.solve(asVector(sides[s]));
  }
  factor.solve(sides[0], scratch);
  factor.solve(sides[1], sides[2], sides[3], scratch);
  double error = 0;
  for (std::size_t s = 0; s < 4; ++s)
    error = std::max(error, (asVector(sides[s]) - expected[s]).norm() / expected[s].norm());
  return error;
}

TEST(SupernodalCholesky, SolvesTheSecondDifferenceInClosedForm) {
  // -x'' = 2 between two zeros: x = t (n + 1 - t), at all sizes around those of blocks and tiles.
  for (const int n : {1, 2, 3, 7, 8, 9, 15, 16, 17, 31, 33, 64, 200}) {
    Triplets entries;
    for (int i = 0; i < n; ++i) {
      entries.emplace_back(i, i, 2);
      if (i > 0) entries.emplace_back(i, i - 1, -1);
    }
    SupernodalCholesky factor;
    SupernodalCholesky::Scratch scratch;
    ASSERT_TRUE(factor.factorize(matrix(n, entries)));
    ASSERT_EQ(factor.size(), static_cast<std::size_t>(n));
    Floats x(factor.size(), 2), y(factor.size(), 4), z(factor.size(), 0), one(factor.size(), 2);
    factor.solve(x, y, z, scratch);
    factor.solve(one, scratch);
    const float tolerance = 2e-6f * static_cast<float>(n * n * n);
    for (int i = 0; i < n; ++i) {
      const auto exact = static_cast<float>((i + 1) * (n - i));
      const auto k = static_cast<std::size_t>(i);
      EXPECT_NEAR(x[k], exact, tolerance);
      EXPECT_NEAR(y[k], 2 * exact, 2 * tolerance);
      EXPECT_NEAR(one[k], exact, tolerance);
      EXPECT_EQ(z[k], 0);
    }
  }
}

TEST(SupernodalCholesky, AgreesWithEigenOnShells) {
  EXPECT_LT(errorBesideEigen(torusShell(5, 4)), 3e-6);
  EXPECT_LT(errorBesideEigen(torusShell(23, 17)), 3e-6);
  EXPECT_LT(errorBesideEigen(torusShell(60, 41)), 3e-6);
}

TEST(SupernodalCholesky, AgreesWithEigenOnRandomPatterns) {
  for (const int n : {20, 90, 400}) {
    Random random(static_cast<std::uint64_t>(n));
    Triplets entries;
    for (int k = 0; k < 3 * n; ++k) {
      const auto i = static_cast<int>(random.uniform(0, n)),
                 j = static_cast<int>(random.uniform(0, n));
      if (i != j) entries.emplace_back(std::max(i, j), std::min(i, j), random.uniform(-1, 1));
    }
    for (int i = 0; i < n; ++i) entries.emplace_back(i, i, random.uniform(12, 20));
    EXPECT_LT(errorBesideEigen(matrix(n, entries)), 1e-6) << n;
  }
}

TEST(SupernodalCholesky, TakesADenseMatrix) {
  const Eigen::MatrixXd b = Eigen::MatrixXd::Random(230, 230);
  const Eigen::MatrixXd a = b * b.transpose() + 100 * Eigen::MatrixXd::Identity(230, 230);
  EXPECT_LT(errorBesideEigen(a.sparseView()), 3e-6);
}

// Two tori, small triangles and single points, as meshes with eyes, teeth and hair have them.
SparseMatrix pieces() {
  Triplets entries = torusLaplacian(40, 33, 0, 1);
  int n = 40 * 33;
  const Triplets second = torusLaplacian(30, 22, n, 2);
  entries.insert(entries.end(), second.begin(), second.end());
  n += 30 * 22;
  for (int k = 0; k < 50; ++k, n += 3)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) entries.emplace_back(n + i, n + j, i == j ? 2 : -1);
  for (int k = 0; k < 40; ++k, ++n) entries.emplace_back(n, n, 0);
  return shell(matrix(n, entries), 0.1);
}

TEST(SupernodalCholesky, SolvesDisconnectedPiecesOnTheirOwn) {
  const SparseMatrix a = pieces();
  EXPECT_LT(errorBesideEigen(a), 3e-6);
  SupernodalCholesky factor;
  SupernodalCholesky::Scratch scratch;
  ASSERT_TRUE(factor.factorize(a));
  Floats x(factor.size(), 0);
  x[5] = 1;
  factor.solve(x, scratch);
  EXPECT_NE(x[5], 0);
  for (std::size_t i = 40 * 33; i < x.size(); ++i) EXPECT_EQ(x[i], 0) << i;
}

TEST(SupernodalCholesky, ReadsTheLowerTriangleOnly) {
  const SparseMatrix a = torusShell(20, 11);
  SupernodalCholesky whole, lower;
  SupernodalCholesky::Scratch scratch;
  ASSERT_TRUE(whole.factorize(a));
  ASSERT_TRUE(lower.factorize(a.triangularView<Eigen::Lower>()));
  Floats x = randomFloats(whole.size(), 3), y = x;
  whole.solve(x, scratch);
  lower.solve(y, scratch);
  EXPECT_EQ(x, y);
}

TEST(SupernodalCholesky, RefusesWhatIsNotPositiveDefinite) {
  SparseMatrix good = torusShell(20, 11);
  SupernodalCholesky factor;
  ASSERT_TRUE(factor.factorize(good));
  const SparseMatrix singular = matrix(20 * 11, torusLaplacian(20, 11, 0, 7));
  EXPECT_FALSE(factor.factorize(singular));
  EXPECT_EQ(factor.size(), 0u);
  EXPECT_EQ(factor.nonZeros(), 0u);
  EXPECT_FALSE(factor.factorize(-good));
  for (const double bad : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), 1e-90}) {
    SparseMatrix a = good;
    a.coeffRef(77, 77) = bad;
    EXPECT_FALSE(factor.factorize(a)) << bad;
    EXPECT_FALSE(factor.factorize(matrix(1, {{0, 0, bad}}))) << bad;
  }
  SparseMatrix a = good;
  a.coeffRef(77, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(factor.factorize(a));
  EXPECT_TRUE(factor.factorize(good));
  EXPECT_TRUE(factor.factorize(SparseMatrix(0, 0)));
  EXPECT_EQ(factor.size(), 0u);
}

TEST(SupernodalCholesky, GivesTheSameBitsOnAnyNumberOfThreads) {
  for (const SparseMatrix& a : {torusShell(70, 50), pieces()}) {
    Floats first[4];
    for (const int threads : {1, 2, 3}) {
      const ThreadLimit limit(threads);
      SupernodalCholesky factor;
      SupernodalCholesky::Scratch scratch;
      ASSERT_TRUE(factor.factorize(a));
      Floats sides[4];
      for (std::size_t s = 0; s < 4; ++s) sides[s] = randomFloats(factor.size(), s + 1);
      factor.solve(sides[0], scratch);
      factor.solve(sides[1], sides[2], sides[3], scratch);
      for (std::size_t s = 0; s < 4; ++s) {
        if (threads == 1) first[s] = sides[s];
        EXPECT_EQ(sides[s], first[s]) << threads << " threads";
      }
    }
  }
}

// Entries of the factor, when rows are eliminated in that order.
double fill(const cholesky::Graph& graph, const std::vector<int>& order) {
  double entries = 0;
  for (const cholesky::Supernode& node : cholesky::findSupernodes(graph, order).nodes)
    entries += node.width * (0.5 * node.width + static_cast<double>(node.below.size()));
  return entries;
}

TEST(NestedDissection, OrdersEachNodeOnceWithLittleFill) {
  const cholesky::Graph graph = cholesky::graphOf(torusShell(80, 60));
  const std::vector<int> order = cholesky::nestedDissection(graph);
  std::vector<int> sorted = order, all(order.size());
  std::sort(sorted.begin(), sorted.end());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(sorted, all);
  EXPECT_LT(fill(graph, order), 0.2 * fill(graph, all));
}

}  // namespace
}  // namespace fascia
