#pragma once

#include <memory>

#include <Eigen/SparseCore>

namespace fascia {

using SparseMatrix = Eigen::SparseMatrix<double>;

// What the caller promises about a square matrix. Of a symmetric one only the lower triangle is
// read.
enum class MatrixKind { symmetric, general };

// Solves A x = b for many b and many A of one pattern: keeps the ordering (symbolic part) while the
// pattern of A stays, and the numbers until the next factorize().
// Symmetric: L D Lᵀ without pivoting, which also takes indefinite matrices; where a pivot vanishes,
// and for general matrices: L U with partial pivoting.
class SparseFactorization {
 public:
  explicit SparseFactorization(MatrixKind kind = MatrixKind::general);
  ~SparseFactorization();
  SparseFactorization(SparseFactorization&&) noexcept;
  SparseFactorization& operator=(SparseFactorization&&) noexcept;

  // False if A is singular or not finite; then solve() fails until the next success.
  [[nodiscard]] bool factorize(const SparseMatrix& a);
  // x may be b. False, and x unchanged, if there is no factorisation or x would not be finite.
  [[nodiscard]] bool solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) const;

  int symbolicCount() const;  // how often the pattern was analysed: once, as long as it stays

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Solve once.
[[nodiscard]] bool solveSparse(const SparseMatrix& a, const Eigen::VectorXd& b, Eigen::VectorXd& x,
                               MatrixKind kind = MatrixKind::general);

}  // namespace fascia
