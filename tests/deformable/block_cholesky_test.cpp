#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <fascia/base/random.h>
#include <fascia/deformable/solve/block_cholesky.h>

namespace fascia {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

Mat3 randomBlock(Random& random) {
  Mat3 block;
  for (double& x : block.reshaped()) x = random.uniform(-1, 1);
  return block;
}

// A positive matrix of the pattern, in both forms.
Eigen::MatrixXd fill(BlockCholesky& sparse, int blocks, const Pairs& pairs, std::uint64_t seed) {
  Random random(seed);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * blocks, 3 * blocks);
  sparse.setPattern(static_cast<std::size_t>(blocks), pairs);
  for (const auto& [i, j] : pairs) {
    const Mat3 block = randomBlock(random);
    sparse.add(i, j, block);
    dense.block<3, 3>(3 * i, 3 * j) = block;
    dense.block<3, 3>(3 * j, 3 * i) = block.transpose();
  }
  for (int i = 0; i < blocks; ++i) {
    const Mat3 half = randomBlock(random);
    const Mat3 block = half * half.transpose() + 20 * Mat3::Identity();
    sparse.add(i, i, block);
    dense.block<3, 3>(3 * i, 3 * i) = block;
  }
  return dense;
}

Pairs randomPairs(int blocks, int count, std::uint64_t seed) {
  Random random(seed);
  Pairs pairs;
  while (static_cast<int>(pairs.size()) < count) {
    const int i = static_cast<int>(random.uniform(0, blocks)),
              j = static_cast<int>(random.uniform(0, blocks));
    if (i > j && std::ranges::find(pairs, std::pair(i, j)) == pairs.end()) pairs.emplace_back(i, j);
  }
  return pairs;
}

Eigen::VectorXd solve(const BlockCholesky& sparse, const Eigen::VectorXd& b) {
  std::vector<Vec3> x(sparse.blockCount());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = b.segment<3>(3 * static_cast<long>(i));
  sparse.solve(x);
  Eigen::VectorXd result(b.size());
  for (std::size_t i = 0; i < x.size(); ++i) result.segment<3>(3 * static_cast<long>(i)) = x[i];
  return result;
}

TEST(BlockCholesky, SolvesLikeADenseFactorisation) {
  for (const int pairs : {0, 10, 40}) {
    BlockCholesky sparse;
    const Eigen::MatrixXd A = fill(sparse, 15, randomPairs(15, pairs, 2), 3);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(45, -1, 2);
    ASSERT_TRUE(sparse.factorize());
    EXPECT_LT((solve(sparse, b) - A.llt().solve(b)).norm(), 1e-13);
  }
}

TEST(BlockCholesky, FillsNothingInChainsAndTrees) {
  Pairs chain, tree;
  for (int i = 1; i < 500; ++i) chain.emplace_back(i, i - 1), tree.emplace_back(i, (i - 1) / 3);
  for (const Pairs& pairs : {chain, tree}) {
    BlockCholesky sparse;
    sparse.setPattern(500, pairs);
    EXPECT_EQ(sparse.fillCount(), pairs.size());
  }
}

TEST(BlockCholesky, LeavesOutRowsThatFollowFromOthers) {
  // A = B Bᵀ with rows of B that repeat others: a rank of 9 in 12 rows.
  Random random(4);
  Eigen::MatrixXd B(12, 12);
  for (double& x : B.reshaped()) x = random.uniform(-1, 1);
  B.row(4) = B.row(1) - 2 * B.row(2);
  B.row(9) = B.row(0) + B.row(5);
  B.row(10) = 3 * B.row(7);
  const Eigen::MatrixXd A = B * B.transpose();
  BlockCholesky sparse;
  sparse.setPattern(4, randomPairs(4, 6, 1));
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j <= i; ++j) sparse.add(i, j, A.block<3, 3>(3 * i, 3 * j));
  sparse.factorizeAndFindDependent(1e-10);
  int dropped = 0;
  for (int block = 0; block < 4; ++block) {
    for (int row = 0; row < 3; ++row) {
      if ((sparse.dropped()[static_cast<std::size_t>(block)] >> row & 1) == 0) continue;
      ++dropped;
      std::vector<Vec3> n(4);
      sparse.dependence(block, row, n);
      Eigen::VectorXd flat(12);
      for (int i = 0; i < 4; ++i) flat.segment<3>(3 * i) = n[static_cast<std::size_t>(i)];
      EXPECT_EQ(n[static_cast<std::size_t>(block)][row], 1);
      EXPECT_LT((B.transpose() * flat).norm(), 1e-9);
    }
  }
  EXPECT_EQ(dropped, 3);
  const Eigen::VectorXd b = A * Eigen::VectorXd::LinSpaced(12, 1, 2);
  EXPECT_LT((A * solve(sparse, b) - b).norm(), 1e-9);
}

TEST(BlockCholesky, SaysWhenTheMatrixIsNotPositive) {
  BlockCholesky sparse;
  sparse.setPattern(1, Pairs{});
  sparse.add(0, 0, -Mat3::Identity());
  EXPECT_FALSE(sparse.factorize());
}

}  // namespace
}  // namespace fascia
