#pragma once

#include <cmath>

#include <Eigen/Core>

#include <fascia/deformable/solve/dense_kernels.h>

// Cholesky's factorisation for the matrices of single bodies, 12 to some 100 rows. Eigen's own is
// made for larger ones: its blocks and packing take longer than the arithmetic here.
namespace fascia {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Bodies of so many coordinates, which are larger than the paper's, spend their time in matrices.
inline constexpr Eigen::Index kManyCoordinates = 36;

// A = L Lᵀ in place: reads and writes the lower triangle. False if A is not positive.
[[nodiscard]] inline bool choleskyInPlace(Eigen::MatrixXd& A) {
  const Eigen::Index n = A.rows();
  if (n >= kManyCoordinates) return factorDense(A.data(), static_cast<std::size_t>(n));
  for (Eigen::Index j = 0; j < n; ++j) {
    double* column = A.data() + j * n;
    if (!(column[j] > 0)) return false;
    const double scale = 1 / std::sqrt(column[j]);
    for (Eigen::Index i = j; i < n; ++i) column[i] *= scale;
    for (Eigen::Index k = j + 1; k < n; ++k) {
      double* target = A.data() + k * n;
      const double factor = column[k];
      for (Eigen::Index i = k; i < n; ++i) target[i] -= factor * column[i];
    }
  }
  return true;
}

// Columns of right sides come in groups of this size, so that the inner loops need no remainder.
inline constexpr Eigen::Index kColumnGroup = 4;
constexpr Eigen::Index paddedColumns(Eigen::Index count) {
  return (count + kColumnGroup - 1) / kColumnGroup * kColumnGroup;
}

// target += factor * source, of rows with a padded number of columns.
inline void addScaledRow(double factor, const double* source, double* target,
                         Eigen::Index columns) {
  for (Eigen::Index first = 0; first < columns; first += kColumnGroup)
    for (Eigen::Index c = first; c < first + kColumnGroup; ++c) target[c] += factor * source[c];
}

// X ← (L Lᵀ)⁻¹ X, all right sides at once, along rows of X. X has padded columns.
inline void choleskySolveInPlace(const Eigen::MatrixXd& L, RowMatrix& X) {
  const Eigen::Index n = L.rows(), columns = X.cols();
  const auto row = [&](Eigen::Index i) { return X.data() + i * columns; };
  for (Eigen::Index j = 0; j < n; ++j) {
    X.row(j) *= 1 / L(j, j);
    for (Eigen::Index i = j + 1; i < n; ++i) addScaledRow(-L(i, j), row(j), row(i), columns);
  }
  for (Eigen::Index j = n; j-- > 0;) {
    for (Eigen::Index i = j + 1; i < n; ++i) addScaledRow(-L(i, j), row(i), row(j), columns);
    X.row(j) *= 1 / L(j, j);
  }
}

// The same of one right side.
inline void choleskySolveInPlace(const Eigen::MatrixXd& L, Eigen::VectorXd& x) {
  const Eigen::Index n = L.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    x[j] /= L(j, j);
    x.tail(n - 1 - j) -= x[j] * L.col(j).tail(n - 1 - j);
  }
  for (Eigen::Index j = n; j-- > 0;)
    x[j] = (x[j] - L.col(j).tail(n - 1 - j).dot(x.tail(n - 1 - j))) / L(j, j);
}

}  // namespace fascia
