#include <algorithm>
#include <array>
#include <cmath>

#include <fascia/field/registry.h>

#include <fascia/base/assert.h>

namespace fascia {

namespace {

constexpr std::array<ParameterInfo, 1> kTwistParameters{
    {{"angle_rad", 0, -2 * kPi, 2 * kPi, "turn of the +z end against the -z end"}}};

// Barr 1984, §3.3, axial twist with θ(z) = rate z, rate = angle / (2 zHalf):
//   X = x cos θ − y sin θ, Y = x sin θ + y cos θ, Z = z.
class TwistDeformation final : public Deformation {
 public:
  std::string_view name() const override { return "twist"; }
  std::span<const ParameterInfo> parameters() const override { return kTwistParameters; }
  Vec3 forward(std::span<const double> p, double zHalf_m, const Vec3& x) const override {
    FASCIA_ASSERT(!p.empty() && zHalf_m > 0, "a deformation acts along a length");
    return turned(angle(p, zHalf_m, x.z()), x);
  }
  Vec3 inverse(std::span<const double> p, double zHalf_m, const Vec3& x) const override {
    FASCIA_ASSERT(!p.empty() && zHalf_m > 0, "a deformation acts along a length");
    return turned(-angle(p, zHalf_m, x.z()), x);
  }
  Mat3 jacobian(std::span<const double> p, double zHalf_m, const Vec3& x) const override {
    const double theta = angle(p, zHalf_m, x.z());
    const double rate = std::abs(x.z()) <= zHalf_m ? p[0] / (2 * zHalf_m) : 0;
    const double s = std::sin(theta), c = std::cos(theta);
    Mat3 j;
    j << c, -s, -rate * (s * x.x() + c * x.y()), s, c, rate * (c * x.x() - s * x.y()), 0, 0, 1;
    return j;
  }
  Box bounds(std::span<const double>, double, const Box& box) const override {
    const Vec3 reach = box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs());
    const double radius = std::hypot(reach.x(), reach.y());
    return {Vec3(-radius, -radius, box.low.z()), Vec3(radius, radius, box.high.z())};
  }
  double invertibleAmount(std::span<const double> p, double, const Box&) const override {
    return p[0];
  }
  DeformationKernel kernel(std::span<const double> p, double zHalf_m, const Box&) const override {
    return {DeformationKernel::Kind::twist, static_cast<float>(zHalf_m),
            static_cast<float>(p[0] / (2 * zHalf_m))};
  }

 private:
  static double angle(std::span<const double> p, double zHalf_m, double z) {
    return 0.5 * p[0] * std::clamp(z / zHalf_m, -1.0, 1.0);
  }
  static Vec3 turned(double theta, const Vec3& x) {
    const double s = std::sin(theta), c = std::cos(theta);
    return {c * x.x() - s * x.y(), s * x.x() + c * x.y(), x.z()};
  }
};

}  // namespace

const Deformation& twistDeformation() {
  static const TwistDeformation kDeformation;
  return kDeformation;
}

}  // namespace fascia
