#include <fascia/measure/best_rotation.h>

#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

using Mat4 = Eigen::Matrix4d;

// Horn 1987, "Closed-Form Solution of Absolute Orientation Using Unit Quaternions": the wanted
// quaternion (w, x, y, z) is the eigenvector of this matrix that belongs to the largest
// eigenvalue. Horn's S is Mᵀ.
Mat4 hornMatrix(const Mat3& M) {
  const double xx = M(0, 0), yy = M(1, 1), zz = M(2, 2);
  const double xy = M(1, 0), yx = M(0, 1), xz = M(2, 0), zx = M(0, 2), yz = M(2, 1), zy = M(1, 2);
  Mat4 n;
  n << xx + yy + zz, yz - zy, zx - xz, xy - yx,  //
      yz - zy, xx - yy - zz, xy + yx, zx + xz,   //
      zx - xz, xy + yx, yy - xx - zz, yz + zy,   //
      xy - yx, zx + xz, yz + zy, zz - xx - yy;
  return n;
}

// Theobald 2005, "Rapid calculation of RMSDs using a quaternion-based characteristic polynomial":
// λ⁴ + c₂λ² + c₁λ + c₀ is convex beyond its largest root, so that Newton's method comes down to
// it from any bound above.
double largestEigenvalue(const Mat4& n, const Mat3& M) {
  const double c2 = -2 * M.squaredNorm(), c1 = -8 * M.determinant(), c0 = n.determinant();
  double lambda = std::sqrt(3.0) * M.norm();  // at least the sum of M's singular values
  for (int i = 0; i < 60; ++i) {
    const double square = lambda * lambda;
    const double slope = 4 * square * lambda + 2 * c2 * lambda + c1;
    if (!(slope > 0)) break;
    const double step = (square * square + c2 * square + c1 * lambda + c0) / slope;
    lambda -= step;
    if (!(std::abs(step) > 1e-14)) break;
  }
  return lambda;
}

// The column of the adjugate of a singular symmetric matrix with the largest cofactor on the
// diagonal: the adjugate is a multiple of q qᵀ. That cofactor is the column's own entry there.
Eigen::Vector4d nullVector(const Mat4& a, double& largest) {
  const auto cofactor = [&a](int i, int j) {
    Mat3 minor;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) minor(r, c) = a(r + (r >= i ? 1 : 0), c + (c >= j ? 1 : 0));
    return ((i + j) % 2 == 0 ? 1 : -1) * minor.determinant();
  };
  int best = 0;
  std::array<double, 4> diagonal{};
  for (int i = 0; i < 4; ++i) {
    diagonal[static_cast<std::size_t>(i)] = std::abs(cofactor(i, i));
    if (diagonal[static_cast<std::size_t>(i)] > diagonal[static_cast<std::size_t>(best)]) best = i;
  }
  largest = diagonal[static_cast<std::size_t>(best)];
  return {cofactor(0, best), cofactor(1, best), cofactor(2, best), cofactor(3, best)};
}

}  // namespace

Mat3 bestRotation(const Mat3& M) {
  FASCIA_ASSERT(M.allFinite(), "the moments are finite");
  const double size = M.norm();
  if (!(size > 0) || !std::isfinite(size)) return Mat3::Identity();
  const Mat3 scaled = M / size;
  const Mat4 n = hornMatrix(scaled);
  double cofactor = 0;
  Eigen::Vector4d q = nullVector(n - largestEigenvalue(n, scaled) * Mat4::Identity(), cofactor);
  // The cofactor is the product of the distances to the other eigenvalues (times at least ¼): next
  // to nothing where the largest is not alone, and the quaternion then not exact.
  constexpr double kAlone = 1e-4;
  if (!(cofactor > kAlone)) q = Eigen::SelfAdjointEigenSolver<Mat4>(n).eigenvectors().col(3);
  return Quat(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}

}  // namespace fascia
