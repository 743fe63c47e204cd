#pragma once

#include <span>

#include <fascia/math/ode/system.h>

namespace fascia {

// The matrix that every implicit method of a second-order system needs, M − a ∂f/∂v − b ∂f/∂r, with
// the driven coordinates taken out (unit rows and columns), its derivatives and its factorisation.
class ImplicitMatrix {
 public:
  // Evaluates the derivatives at the state and factorises. False if singular or not finite.
  [[nodiscard]] bool update(SecondOrderSystem& system, double t_s, std::span<const double> r,
                            std::span<const double> v, double a_s, double b_s2);
  // Right sides must be zero for driven coordinates.
  [[nodiscard]] bool solve(const Eigen::VectorXd& right, Eigen::VectorXd& x) const {
    return factorization_.solve(right, x);
  }
  const SparseMatrix& forceByPosition() const { return dfdr_; }

 private:
  void removeDriven(std::span<const double> inverseMass);

  MatrixKind kind_ = MatrixKind::general;
  SparseFactorization factorization_{MatrixKind::general};
  SparseMatrix dfdr_, dfdv_, mass_, matrix_;
};

}  // namespace fascia
