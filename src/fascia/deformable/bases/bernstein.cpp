#include <array>
#include <cmath>

#include <fascia/deformable/bases/basis.h>
#include <fascia/deformable/bases/check_range.h>

namespace fascia {
namespace {

// All Bernstein polynomials of one degree at u, and their derivatives by u.
struct Bernstein {
  std::array<double, kMaxLatticeCells + 1> value{}, slope{};
};

Bernstein bernsteinAt(int degree, double u) {
  Bernstein b;
  b.value[0] = 1;
  for (int n = 1; n <= degree; ++n) {  // de Casteljau's recursion, B_i^n from B^(n-1)
    const auto lower = b.value;
    for (int i = 0; i <= n; ++i) {
      const double left = i > 0 ? lower[i - 1] : 0, right = i < n ? lower[i] : 0;
      if (n == degree) b.slope[i] = n * (left - right);
      b.value[i] = u * left + (1 - u) * right;
    }
  }
  return b;
}

class BernsteinBasis final : public Basis {
 public:
  BernsteinBasis(int dimension, const Eigen::Vector3i& cells, const Box& domain)
      : dimension_(dimension), cells_(cells), low_(domain.low) {
    scale_ = domain.size().cwiseInverse();
    if (dimension == 2) cells_.z() = 0, scale_.z() = 0;
  }
  std::string_view name() const override { return "bernstein"; }
  int dimension() const override { return dimension_; }
  int size() const override { return (cells_.array() + 1).prod(); }
  int degree() const override { return cells_.sum(); }
  Degrees slopeDegrees() const override { return {cells_, degree() - 1}; }

  void values(const Vec3& X, Eigen::Ref<Eigen::VectorXd> p) const override {
    const std::array<Bernstein, 3> b = factorsAt(X);
    forEach([&](Eigen::Index n, int i, int j, int k) {
      p[n] = b[0].value[i] * b[1].value[j] * b[2].value[k];
    });
  }
  void gradients(const Vec3& X, Eigen::Ref<Eigen::MatrixXd> dp) const override {
    const std::array<Bernstein, 3> b = factorsAt(X);
    forEach([&](Eigen::Index n, int i, int j, int k) {
      dp(n, 0) = scale_.x() * b[0].slope[i] * b[1].value[j] * b[2].value[k];
      dp(n, 1) = scale_.y() * b[0].value[i] * b[1].slope[j] * b[2].value[k];
      dp(n, 2) = scale_.z() * b[0].value[i] * b[1].value[j] * b[2].slope[k];
    });
  }

 private:
  std::array<Bernstein, 3> factorsAt(const Vec3& X) const {
    const Vec3 u = (X - low_).cwiseProduct(scale_);
    return {bernsteinAt(cells_.x(), u.x()), bernsteinAt(cells_.y(), u.y()),
            bernsteinAt(cells_.z(), u.z())};
  }
  template <class Visit>
  void forEach(Visit&& visit) const {
    Eigen::Index n = 0;
    for (int k = 0; k <= cells_.z(); ++k)
      for (int j = 0; j <= cells_.y(); ++j)
        for (int i = 0; i <= cells_.x(); ++i) visit(n++, i, j, k);
  }

  int dimension_;
  Eigen::Vector3i cells_;
  Vec3 low_, scale_;
};

}  // namespace

BasisPtr makeBernsteinBasis(int dimension, const Eigen::Vector3i& cells, const Box& domain) {
  checkRange("basis", "dimension", dimension, 2, 3);
  for (int axis = 0; axis < dimension; ++axis) {
    checkRange("basis", "cells along an axis", cells[axis], 1, kMaxLatticeCells);
    checkRange("basis", "edge of the domain (m)", domain.size()[axis], 1e-9, 1e9);
  }
  return std::make_shared<BernsteinBasis>(dimension, cells, domain);
}

}  // namespace fascia
