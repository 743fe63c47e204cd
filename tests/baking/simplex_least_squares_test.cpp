#include <fascia/baking/simplex_least_squares.h>

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <fascia/base/random.h>

namespace fascia {
namespace {

// Columns that are alike, as bones near each other move, and a target that some of them make.
struct Problem {
  CandidateMatrix G;
  CandidateVector g;

  double cost(const CandidateVector& w) const { return 0.5 * w.dot(G * w) - g.dot(w); }
};

Problem randomProblem(std::uint64_t seed, int candidates) {
  Random random(seed);
  const auto number = [&] { return random.uniform(-1.0, 1.0); };
  const int rows = 3 * candidates;
  Eigen::MatrixXd A(rows, candidates);
  Eigen::VectorXd common(rows), b(rows);
  for (int r = 0; r < rows; ++r) {
    common[r] = number();
    b[r] = common[r] + 0.3 * number();
  }
  for (int c = 0; c < candidates; ++c) {
    for (int r = 0; r < rows; ++r) A(r, c) = common[r] + 0.5 * number();
  }
  return {A.transpose() * A, A.transpose() * b};
}

// The best weights on given members, if they are no less than 0.
bool onMembers(const Problem& problem, const std::vector<int>& members, CandidateVector& w) {
  const auto n = static_cast<Eigen::Index>(members.size());
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Eigen::VectorXd rhs = Eigen::VectorXd::Ones(n + 1);
  for (Eigen::Index r = 0; r < n; ++r) {
    const int row = members[static_cast<std::size_t>(r)];
    for (Eigen::Index c = 0; c < n; ++c) {
      K(r, c) = problem.G(row, members[static_cast<std::size_t>(c)]);
    }
    K(r, n) = K(n, r) = 1;
    rhs[r] = problem.g[row];
  }
  const Eigen::VectorXd found = K.fullPivLu().solve(rhs);
  w = CandidateVector::Zero(problem.g.size());
  for (Eigen::Index r = 0; r < n; ++r) {
    if (found[r] < 0) return false;
    w[members[static_cast<std::size_t>(r)]] = found[r];
  }
  return true;
}

// Tries every choice of members.
double lowestCost(const Problem& problem, int most) {
  const auto count = static_cast<int>(problem.g.size());
  double lowest = 1e300;
  for (unsigned mask = 1; mask < 1u << count; ++mask) {
    std::vector<int> members;
    for (int c = 0; c < count; ++c) {
      if (mask >> c & 1u) members.push_back(c);
    }
    CandidateVector w;
    if (static_cast<int>(members.size()) > most || !onMembers(problem, members, w)) continue;
    lowest = std::min(lowest, problem.cost(w));
  }
  return lowest;
}

TEST(SimplexLeastSquares, WeightsAreConvexAndFew) {
  for (std::uint64_t seed = 1; seed < 40; ++seed) {
    const Problem problem = randomProblem(seed, 20);
    const CandidateVector w = solveOnSimplex(problem.G, problem.g, 4, CandidateVector::Zero(20));
    EXPECT_NEAR(w.sum(), 1, 1e-9);
    EXPECT_GE(w.minCoeff(), 0);
    EXPECT_LE((w.array() > 0).count(), 4);
    EXPECT_GT((w.array() > 0).count(), 1);
  }
}

TEST(SimplexLeastSquares, FindsTheBestChoiceNearlyAlways) {
  int best = 0, all = 0;
  for (std::uint64_t seed = 1; seed < 60; ++seed) {
    const Problem problem = randomProblem(seed, 9);
    const CandidateVector w = solveOnSimplex(problem.G, problem.g, 3, CandidateVector::Zero(9));
    const double found = problem.cost(w), lowest = lowestCost(problem, 3);
    EXPECT_GE(found, lowest - 1e-9 * std::abs(lowest));
    EXPECT_LT(found, lowest + 0.02 * std::abs(lowest)) << seed;
    ++all;
    best += found < lowest + 1e-9 * std::abs(lowest);
  }
  EXPECT_GE(10 * best, 9 * all);
}

// Without a bound that bites it is the optimum: every gradient on the support is one number, and no
// other is below it.
TEST(SimplexLeastSquares, MeetsTheConditionsOfAnOptimum) {
  for (std::uint64_t seed = 1; seed < 40; ++seed) {
    const Problem problem = randomProblem(seed, 8);
    const CandidateVector w =
        solveOnSimplex(problem.G, problem.g, kMostNonZero, CandidateVector::Zero(8));
    const CandidateVector gradient = problem.G * w - problem.g;
    const double multiplier = gradient.dot(w);
    for (Eigen::Index c = 0; c < 8; ++c) {
      EXPECT_GT(gradient[c], multiplier - 1e-7);
      if (w[c] > 1e-6) {
        EXPECT_NEAR(gradient[c], multiplier, 1e-7);
      }
    }
  }
}

TEST(SimplexLeastSquares, NeverEndsAboveItsStart) {
  for (std::uint64_t seed = 1; seed < 40; ++seed) {
    const Problem problem = randomProblem(seed, 20);
    CandidateVector start = CandidateVector::Zero(20);
    start[2] = start[5] = start[11] = 1.0 / 3;
    const CandidateVector w = solveOnSimplex(problem.G, problem.g, 3, start);
    EXPECT_LE(problem.cost(w), problem.cost(start));
  }
}

}  // namespace
}  // namespace fascia
