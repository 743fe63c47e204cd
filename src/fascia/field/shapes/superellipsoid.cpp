#include <array>

#include <fascia/field/registry.h>
#include <fascia/field/shape.h>
#include <fascia/field/shapes/superquadric.h>

namespace fascia {

namespace {

constexpr std::array<ParameterInfo, 5> kSuperellipsoidParameters{
    {{"half_x_m", 0.1, 1e-4, 100, "half size along x"},
     {"half_y_m", 0.1, 1e-4, 100, "half size along y"},
     {"half_z_m", 0.1, 1e-4, 100, "half size along z"},
     {"exponent_e1", 1, 0.1, 2, "north to south: 0.1 flat ends, 1 round, 2 pointed ends"},
     {"exponent_e2", 1, 0.1, 2, "around z: 0.1 square, 1 round, 2 diamond"}}};

class Superellipsoid final : public Shape {
 public:
  std::string_view name() const override { return "superellipsoid"; }
  std::span<const ParameterInfo> parameters() const override { return kSuperellipsoidParameters; }
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

const Shape& superellipsoidShape() {
  static const Superellipsoid kShape;
  return kShape;
}

}  // namespace fascia
