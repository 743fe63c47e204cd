#pragma once

#include <functional>

#include <Eigen/Core>

namespace fascia {

// A bounded nonlinear least-squares problem: least |r(x)|² with low ≤ x ≤ high.
struct LeastSquaresProblem {
  // Writes all residuals at x; their number must not change.
  std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& residuals)> residuals;
  Eigen::Index residualCount = 0;
  Eigen::VectorXd low, high;
  Eigen::VectorXd step;  // of the finite differences; 0 keeps that parameter fixed
};

struct LeastSquaresResult {
  double cost = 0;  // |r|²
  int iterations = 0;
};

// Levenberg (1944) and Marquardt (1963) with forward differences. Parameters at a bound that would
// leave it are held there for that step. Always ends; never worse than where it began.
LeastSquaresResult minimize(const LeastSquaresProblem& problem, Eigen::VectorXd& x,
                            int mostIterations);

}  // namespace fascia
