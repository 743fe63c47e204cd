#include <fascia/math/ode/implicit_matrix.h>

#include <fascia/base/assert.h>

namespace fascia {

bool ImplicitMatrix::update(SecondOrderSystem& system, double t_s, std::span<const double> r,
                            std::span<const double> v, double a_s, double b_s2) {
  if (kind_ != system.jacobianKind()) {
    kind_ = system.jacobianKind();
    factorization_ = SparseFactorization(kind_);
  }
  const std::span<const double> inverseMass = system.inverseMass();
  const auto n = static_cast<Eigen::Index>(system.size());
  system.forceJacobian(t_s, r, v, dfdr_, dfdv_);
  FASCIA_ASSERT(dfdr_.rows() == n && dfdr_.cols() == n, "forces have a column per coordinate");
  FASCIA_ASSERT(dfdv_.rows() == n && dfdv_.cols() == n, "forces have a column per velocity");

  mass_.resize(n, n);
  mass_.setIdentity();
  for (Eigen::Index i = 0; i < n; ++i) {
    const double w = inverseMass[static_cast<std::size_t>(i)];
    if (w > 0) mass_.valuePtr()[i] = 1 / w;
  }
  matrix_ = mass_ - a_s * dfdv_;
  matrix_ = (matrix_ - b_s2 * dfdr_).eval();
  removeDriven(inverseMass);
  return factorization_.factorize(matrix_);
}

void ImplicitMatrix::removeDriven(std::span<const double> inverseMass) {
  const auto driven = [&](Eigen::Index i) {
    return !(inverseMass[static_cast<std::size_t>(i)] > 0);
  };
  for (Eigen::Index column = 0; column < matrix_.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(matrix_, column); entry; ++entry) {
      if (driven(entry.row()) || driven(column)) entry.valueRef() = entry.row() == column ? 1 : 0;
    }
  }
}

}  // namespace fascia
