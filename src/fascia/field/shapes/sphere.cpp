#include <array>

#include <fascia/field/registry.h>
#include <fascia/field/shape.h>
#include <fascia/field/shapes/lattice.h>

namespace fascia {

namespace {

constexpr std::array<ParameterInfo, 1> kSphereParameters{
    {{"radius_m", 0.1, 1e-4, 100, "distance of the surface from the centre"}}};

class Sphere final : public Shape {
 public:
  std::string_view name() const override { return "sphere"; }
  std::span<const ParameterInfo> parameters() const override { return kSphereParameters; }
  double volume_m3(std::span<const double> p) const override {
    return 4.0 / 3.0 * kPi * p[0] * p[0] * p[0];
  }
  Vec3 halfExtents_m(std::span<const double> p) const override { return Vec3::Constant(p[0]); }
  double gauge(std::span<const double> p, const Vec3& x) const override { return x.norm() / p[0]; }
  TriangleMesh tessellate(std::span<const double> p, int detail) const override {
    return latticeSurface(detail, false, [&](const Vec3& direction, bool) {
      return SurfacePoint{p[0] * direction, direction};
    });
  }
  PrimitiveKernel kernel(std::span<const double> p) const override {
    PrimitiveKernel k;
    k.kind = PrimitiveKernel::Kind::sphere;
    k.half_m[0] = static_cast<float>(p[0]);
    return k;
  }
};

}  // namespace

const Shape& sphereShape() {
  static const Sphere kShape;
  return kShape;
}

}  // namespace fascia
