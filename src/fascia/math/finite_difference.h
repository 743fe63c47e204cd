#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace fascia {

// Central differences have an error of O(step²) + O(eps/step): this step balances the two for
// functions whose values and derivatives are about 1.
inline constexpr double kDifferenceStep = 6e-6;

// Step for the coordinate x, exactly representable as a difference from x.
inline double differenceStep(double x, double relativeStep) {
  const double wanted = relativeStep * std::max(1.0, std::abs(x));
  const volatile double shifted = x + wanted;
  return shifted - x;
}

// Gradient of a scalar function: value(x) -> double.
template <class Function>
Eigen::VectorXd numericGradient(Function&& value, Eigen::VectorXd x,
                                double relativeStep = kDifferenceStep) {
  Eigen::VectorXd gradient(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double at = x[i], step = differenceStep(at, relativeStep);
    x[i] = at + step;
    const double above = value(x);
    x[i] = at - step;
    const double below = value(x);
    x[i] = at;
    gradient[i] = (above - below) / (2 * step);
  }
  return gradient;
}

// Jacobian of a vector function: values(x) -> VectorXd. Entry (i, j) = ∂value_i/∂x_j.
template <class Function>
Eigen::MatrixXd numericJacobian(Function&& values, Eigen::VectorXd x,
                                double relativeStep = kDifferenceStep) {
  Eigen::MatrixXd jacobian;
  for (Eigen::Index j = 0; j < x.size(); ++j) {
    const double at = x[j], step = differenceStep(at, relativeStep);
    x[j] = at + step;
    const Eigen::VectorXd above = values(x);
    x[j] = at - step;
    const Eigen::VectorXd below = values(x);
    x[j] = at;
    if (jacobian.size() == 0) jacobian.resize(above.size(), x.size());
    jacobian.col(j) = (above - below) / (2 * step);
  }
  return jacobian;
}

// Largest difference of two gradients or Jacobians relative to their largest entry. Infinite if
// both vanish or one is not finite: a comparison of nothing with nothing must not pass a test.
template <class A, class B>
double derivativeMismatch(const Eigen::MatrixBase<A>& analytic,
                          const Eigen::MatrixBase<B>& numeric) {
  const double size = std::max(analytic.cwiseAbs().maxCoeff(), numeric.cwiseAbs().maxCoeff());
  const double mismatch = (analytic - numeric).cwiseAbs().maxCoeff() / size;
  return size > 0 && analytic.allFinite() && numeric.allFinite() ? mismatch : HUGE_VAL;
}

}  // namespace fascia
