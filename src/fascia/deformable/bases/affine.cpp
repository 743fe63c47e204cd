#include <fascia/deformable/bases/basis.h>
#include <fascia/deformable/bases/check_range.h>

namespace fascia {
namespace {

class AffineBasis final : public Basis {
 public:
  explicit AffineBasis(int dimension) : dimension_(dimension) {}
  std::string_view name() const override { return "affine"; }
  int dimension() const override { return dimension_; }
  int size() const override { return dimension_ + 1; }
  int degree() const override { return 1; }

  void values(const Vec3& X, Eigen::Ref<Eigen::VectorXd> p) const override {
    p.head(dimension_) = X.head(dimension_);
    p[dimension_] = 1;
  }
  void gradients(const Vec3&, Eigen::Ref<Eigen::MatrixXd> dp) const override {
    dp.setZero();
    dp.topLeftCorner(dimension_, dimension_).setIdentity();
  }

 private:
  int dimension_;
};

}  // namespace

BasisPtr makeAffineBasis(int dimension) {
  checkRange("basis", "dimension", dimension, 2, 3);
  return std::make_shared<AffineBasis>(dimension);
}

}  // namespace fascia
