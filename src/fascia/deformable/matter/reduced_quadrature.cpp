#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/QR>

#include <fascia/deformable/bases/basis.h>
#include <fascia/deformable/matter/quadrature.h>

namespace fascia {
namespace {

// Removes points until no more are left than there are moments: along a combination z of points
// that no moment feels, the weights w − t z keep all moments; the first that vanishes goes.
void removeSurplus(const Eigen::MatrixXd& moments, std::vector<double>& weights) {
  const Eigen::Index m = moments.rows(), n = moments.cols();
  if (n <= m) return;
  const Eigen::MatrixXd Q =
      Eigen::HouseholderQR<Eigen::MatrixXd>(moments.transpose()).householderQ();
  Eigen::MatrixXd unfelt = Q.rightCols(n - m);  // a basis of such combinations
  Eigen::Map<Eigen::VectorXd> w(weights.data(), n);
  for (Eigen::Index column = 0; column < unfelt.cols(); ++column) {
    const Eigen::VectorXd z = unfelt.col(column);
    // Of entries that rounding made, no ratio can be trusted.
    const double least = 1e-12 * z.cwiseAbs().maxCoeff();
    Eigen::Index gone = -1;
    double smallest = HUGE_VAL;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (w[i] == 0 || std::abs(z[i]) <= least) continue;
      if (std::abs(w[i] / z[i]) < std::abs(smallest)) smallest = w[i] / z[i], gone = i;
    }
    if (gone < 0) continue;
    for (Eigen::Index i = 0; i < n; ++i)
      if (w[i] != 0) w[i] = i == gone ? 0 : w[i] - smallest * z[i];
    for (Eigen::Index other = column + 1; other < unfelt.cols(); ++other)
      unfelt.col(other) -= unfelt(gone, other) / z[gone] * z;
  }
}

void dropEmpty(Quadrature& rule) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < rule.size(); ++i) {
    if (rule.weights[i] == 0) continue;
    rule.points_m[kept] = rule.points_m[i];
    rule.weights[kept++] = rule.weights[i];
  }
  rule.points_m.resize(kept), rule.weights.resize(kept);
}

}  // namespace

Quadrature reducedQuadrature(const Quadrature& rule, int dimension, int degree) {
  Box box;
  for (const Vec3& p : rule.points_m) box.add(p);
  const Vec3 margin = Vec3::Constant(1e-6 + 1e-6 * box.size().maxCoeff());
  box.low -= margin, box.high += margin;
  const BasisPtr monomials = makePolynomialBasis(dimension, std::clamp(degree, 1, 8), box);
  const Eigen::Index count = monomials->size();
  Quadrature kept;
  // A batch at a time: the cost grows with the cube of a batch, only.
  for (std::size_t next = 0; next < rule.size();) {
    for (; next < rule.size() && static_cast<Eigen::Index>(kept.size()) < 2 * count; ++next)
      kept.add(rule.points_m[next], rule.weights[next]);
    Eigen::MatrixXd moments(count, static_cast<Eigen::Index>(kept.size()));
    for (std::size_t i = 0; i < kept.size(); ++i)
      monomials->values(kept.points_m[i], moments.col(static_cast<Eigen::Index>(i)));
    removeSurplus(moments, kept.weights);
    dropEmpty(kept);
  }
  return kept;
}

}  // namespace fascia
