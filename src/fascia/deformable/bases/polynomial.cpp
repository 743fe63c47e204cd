#include <array>
#include <cmath>
#include <vector>

#include <fascia/deformable/bases/basis.h>
#include <fascia/deformable/bases/check_range.h>

namespace fascia {
namespace {

using Powers = std::array<double, kMaxPolynomialOrder + 1>;

Powers powersOf(double x) {
  Powers powers{1};
  for (std::size_t i = 1; i < powers.size(); ++i) powers[i] = powers[i - 1] * x;
  return powers;
}

class PolynomialBasis final : public Basis {
 public:
  PolynomialBasis(int dimension, int order, const Box& domain)
      : dimension_(dimension), order_(order), center_(domain.center()) {
    scale_ = 2 * domain.size().cwiseInverse();
    if (dimension == 2) scale_.z() = 0;
    for (int total = 0; total <= order; ++total)
      for (int z = 0; z <= (dimension == 3 ? total : 0); ++z)
        for (int y = 0; y <= total - z; ++y) exponents_.push_back({total - z - y, y, z});
  }
  std::string_view name() const override { return "polynomial"; }
  int dimension() const override { return dimension_; }
  int size() const override { return static_cast<int>(exponents_.size()); }
  int degree() const override { return order_; }

  void values(const Vec3& X, Eigen::Ref<Eigen::VectorXd> p) const override {
    const std::array<Powers, 3> powers = powersAt(X);
    for (std::size_t i = 0; i < exponents_.size(); ++i) {
      const Exponents& e = exponents_[i];
      p[static_cast<Eigen::Index>(i)] = powers[0][e[0]] * powers[1][e[1]] * powers[2][e[2]];
    }
  }

  void gradients(const Vec3& X, Eigen::Ref<Eigen::MatrixXd> dp) const override {
    const std::array<Powers, 3> powers = powersAt(X);
    for (std::size_t i = 0; i < exponents_.size(); ++i) {
      const Exponents& e = exponents_[i];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        double product = e[axis] > 0 ? e[axis] * scale_[axis] : 0;
        for (std::size_t a = 0; a < 3; ++a) {
          const std::size_t power = e[a] - (a == axis && e[a] > 0 ? 1 : 0);
          product *= powers[a][power];
        }
        dp(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(axis)) = product;
      }
    }
  }

 private:
  using Exponents = std::array<int, 3>;
  std::array<Powers, 3> powersAt(const Vec3& X) const {
    const Vec3 x = (X - center_).cwiseProduct(scale_);
    return {powersOf(x.x()), powersOf(x.y()), powersOf(x.z())};
  }

  int dimension_, order_;
  Vec3 center_, scale_;
  std::vector<Exponents> exponents_;
};

}  // namespace

BasisPtr makePolynomialBasis(int dimension, int order, const Box& domain) {
  checkRange("basis", "dimension", dimension, 2, 3);
  checkRange("basis", "order", order, 1, kMaxPolynomialOrder);
  for (int axis = 0; axis < dimension; ++axis)
    checkRange("basis", "edge of the domain (m)", domain.size()[axis], 1e-9, 1e9);
  return std::make_shared<PolynomialBasis>(dimension, order, domain);
}

}  // namespace fascia
