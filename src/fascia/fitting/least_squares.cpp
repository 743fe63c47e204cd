#include <fascia/fitting/least_squares.h>

#include <vector>

#include <Eigen/Cholesky>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

constexpr double kFirstDamping = 1e-2, kMostDamping = 1e6;
constexpr double kLeastGain = 1e-5;  // of the cost in one step; below it the work is done

struct Linearisation {
  Eigen::MatrixXd normal;    // JᵀJ
  Eigen::VectorXd gradient;  // Jᵀr
};

Linearisation linearise(const LeastSquaresProblem& problem, const Eigen::VectorXd& x,
                        const Eigen::VectorXd& r) {
  const Eigen::Index n = x.size();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(problem.residualCount, n);
  Eigen::VectorXd moved(problem.residualCount), y = x;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (problem.step[i] == 0) continue;
    // Away from the upper bound, so that the difference stays within both.
    const double h = x[i] + problem.step[i] > problem.high[i] ? -problem.step[i] : problem.step[i];
    y[i] = x[i] + h;
    problem.residuals(y, moved);
    y[i] = x[i];
    jacobian.col(i) = (moved - r) / h;
  }
  return {jacobian.transpose() * jacobian, jacobian.transpose() * r};
}

// (JᵀJ + λ diag JᵀJ) s = −Jᵀr over the parameters that may move.
Eigen::VectorXd dampedStep(const LeastSquaresProblem& problem, const Linearisation& linear,
                           const Eigen::VectorXd& x, double damping) {
  FASCIA_ASSERT(damping > 0 && x.allFinite(), "a step starts somewhere");
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const bool heldLow = x[i] <= problem.low[i] && linear.gradient[i] > 0;
    const bool heldHigh = x[i] >= problem.high[i] && linear.gradient[i] < 0;
    if (problem.step[i] != 0 && !heldLow && !heldHigh) free.push_back(i);
  }
  Eigen::VectorXd step = Eigen::VectorXd::Zero(x.size());
  if (free.empty()) return step;
  Eigen::MatrixXd a = linear.normal(free, free);
  a.diagonal() += damping * a.diagonal();
  a.diagonal().array() += 1e-12 * a.diagonal().maxCoeff() + 1e-30;
  step(free) = -a.ldlt().solve(Eigen::VectorXd(linear.gradient(free)));
  return step;
}

}  // namespace

LeastSquaresResult minimize(const LeastSquaresProblem& problem, Eigen::VectorXd& x,
                            int mostIterations) {
  x = x.cwiseMax(problem.low).cwiseMin(problem.high);
  Eigen::VectorXd r(problem.residualCount), tried(problem.residualCount);
  problem.residuals(x, r);
  LeastSquaresResult result{r.squaredNorm(), 0};
  double damping = kFirstDamping;
  while (result.iterations < mostIterations) {
    ++result.iterations;
    const Linearisation linear = linearise(problem, x, r);
    bool better = false;
    double gain = 0;
    for (; damping < kMostDamping && !better; damping *= better ? 1 : 5) {
      const Eigen::VectorXd y = (x + dampedStep(problem, linear, x, damping))
                                    .cwiseMax(problem.low)
                                    .cwiseMin(problem.high);
      problem.residuals(y, tried);
      const double cost = tried.squaredNorm();
      if (!(cost < result.cost)) continue;
      better = true;
      gain = result.cost - cost;
      x = y;
      r.swap(tried);
      result.cost = cost;
      damping *= 0.2;
    }
    if (!better || gain <= kLeastGain * result.cost) break;
  }
  return result;
}

}  // namespace fascia
