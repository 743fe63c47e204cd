#include <algorithm>
#include <array>
#include <cmath>

#include <fascia/field/registry.h>
#include <fascia/field/shape.h>
#include <fascia/field/shapes/lattice.h>

namespace fascia {

namespace {

constexpr std::array<ParameterInfo, 2> kCapsuleParameters{
    {{"radius_m", 0.1, 1e-4, 100, "distance of the surface from the axis"},
     {"half_length_m", 0.1, 0, 100, "half the length of the axis, without the round ends"}}};

class Capsule final : public Shape {
 public:
  std::string_view name() const override { return "capsule"; }
  std::span<const ParameterInfo> parameters() const override { return kCapsuleParameters; }
  double volume_m3(std::span<const double> p) const override {
    return kPi * p[0] * p[0] * (4.0 / 3.0 * p[0] + 2 * p[1]);
  }
  Vec3 halfExtents_m(std::span<const double> p) const override { return {p[0], p[0], p[0] + p[1]}; }
  // On the side wall: lateral / radius. On an end: s > 0 with |x / s − halfLength e_z| = radius,
  // whose solution is s = (x·x) / (z h + sqrt((z h)² + (x·x) (r² − h²))), written without
  // cancellation.
  double gauge(std::span<const double> p, const Vec3& x) const override {
    const double lateral = std::hypot(x.x(), x.y()), z = std::abs(x.z());
    const double side = lateral / p[0];
    if (z <= side * p[1]) return side;
    const double square = x.squaredNorm(), along = z * p[1];
    // along² + square (r² − h²) = (r |x|)² − (h lateral)²
    const double root = std::max(0.0, p[0] * p[0] * square - std::pow(p[1] * lateral, 2));
    const double sum = along + std::sqrt(root);
    return sum > 0 ? square / sum : 0;
  }
  TriangleMesh tessellate(std::span<const double> p, int detail) const override {
    return latticeSurface(detail, true, [&](const Vec3& direction, bool upper) {
      return SurfacePoint{p[0] * direction + Vec3(0, 0, upper ? p[1] : -p[1]), direction};
    });
  }
  PrimitiveKernel kernel(std::span<const double> p) const override {
    PrimitiveKernel k;
    k.kind = PrimitiveKernel::Kind::capsule;
    k.half_m[0] = static_cast<float>(p[0]);
    k.halfLength_m = static_cast<float>(p[1]);
    return k;
  }
};

}  // namespace

const Shape& capsuleShape() {
  static const Capsule kShape;
  return kShape;
}

}  // namespace fascia
