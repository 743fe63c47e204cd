#include <array>

#include <fascia/field/registry.h>
#include <fascia/field/shape.h>
#include <fascia/field/shapes/superquadric.h>

namespace fascia {

namespace {

constexpr std::array<ParameterInfo, 5> kCylinderParameters{
    {{"half_x_m", 0.1, 1e-4, 100, "half size along x"},
     {"half_y_m", 0.1, 1e-4, 100, "half size along y"},
     {"half_z_m", 0.2, 1e-4, 100, "half size along z"},
     {"rounding", 0.2, 0.1, 1, "of the rims (exponent e1): 0.1 sharp, 1 an ellipsoid"},
     {"exponent_e2", 1, 0.1, 2, "around z: 0.1 square, 1 round, 2 diamond"}}};

// A superquadricOf cylinder, closed by flat ends with rounded rims: the superellipsoid of small e1.
class Cylinder final : public Shape {
 public:
  std::string_view name() const override { return "cylinder"; }
  std::span<const ParameterInfo> parameters() const override { return kCylinderParameters; }
  double volume_m3(std::span<const double> p) const override {
    return fascia::volume_m3(superquadricOf(p));
  }
  Vec3 halfExtents_m(std::span<const double> p) const override { return superquadricOf(p).half_m; }
  double gauge(std::span<const double> p, const Vec3& x) const override {
    return fascia::gauge(superquadricOf(p), x);
  }
  TriangleMesh tessellate(std::span<const double> p, int detail) const override {
    return fascia::tessellate(superquadricOf(p), detail);
  }
  PrimitiveKernel kernel(std::span<const double> p) const override {
    return fascia::kernel(superquadricOf(p));
  }
};

}  // namespace

const Shape& cylinderShape() {
  static const Cylinder kShape;
  return kShape;
}

}  // namespace fascia
