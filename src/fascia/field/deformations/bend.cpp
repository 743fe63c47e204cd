#include <algorithm>
#include <array>
#include <cmath>

#include <fascia/field/registry.h>

#include <fascia/base/assert.h>

namespace fascia {

namespace {

constexpr std::array<ParameterInfo, 1> kBendParameters{
    {{"angle_rad", 0, -kPi, kPi, "between the two ends; positive bends towards +x"}}};

constexpr double kLeastStretch = 0.1;  // of the inner side: smaller makes distances there poor

// Barr 1984, §3.4, here with the centreline along z and towards +x. Curvature k = angle /
// (2 zHalf), ẑ = z clamped to the interval, θ = k ẑ, rest Z = z − ẑ beyond the ends:
//   X = cos θ (x − 1/k) + 1/k + sin θ Z,  Y = y,  Z' = −sin θ (x − 1/k) + cos θ Z.
// (1 − cos θ)/k is written sin²θ / (k (1 + cos θ)), which stays exact for small k. One-to-one where
// 1 − k x > 0: the solid may not reach the centre of curvature.
class BendDeformation final : public Deformation {
 public:
  std::string_view name() const override { return "bend"; }
  std::span<const ParameterInfo> parameters() const override { return kBendParameters; }

  Vec3 forward(std::span<const double> p, double zHalf_m, const Vec3& x) const override {
    FASCIA_ASSERT(!p.empty() && zHalf_m > 0, "a deformation acts along a length");
    if (p[0] == 0) return x;
    const double k = p[0] / (2 * zHalf_m), z = std::clamp(x.z(), -zHalf_m, zHalf_m);
    const double s = std::sin(k * z), c = std::cos(k * z), rest = x.z() - z;
    return {c * x.x() + s * s / (k * (1 + c)) + s * rest, x.y(), -s * x.x() + s / k + c * rest};
  }

  // tan θ = k Z' / (1 − k X) within the bent part; beyond it θ is the nearer end's.
  Vec3 inverse(std::span<const double> p, double zHalf_m, const Vec3& x) const override {
    FASCIA_ASSERT(!p.empty() && zHalf_m > 0, "a deformation acts along a length");
    if (p[0] == 0) return x;
    const double k = p[0] / (2 * zHalf_m);
    const double z = std::atan2(k * x.z(), 1 - k * x.x()) / k;
    const double onAxis = std::clamp(z, -zHalf_m, zHalf_m);
    const double s = std::sin(k * onAxis), c = std::cos(k * onAxis);
    const double across = c * x.x() - s * x.z() + s * s / (k * (1 + c));
    const double rest = onAxis == z ? 0 : s * x.x() + c * x.z() - s / k;
    return {across, x.y(), onAxis + rest};
  }

  Mat3 jacobian(std::span<const double> p, double zHalf_m, const Vec3& x) const override {
    if (p[0] == 0) return Mat3::Identity();
    const double k = p[0] / (2 * zHalf_m), z = std::clamp(x.z(), -zHalf_m, zHalf_m);
    const double s = std::sin(k * z), c = std::cos(k * z);
    const double stretch = z == x.z() ? 1 - k * x.x() : 1;
    Mat3 j;
    j << c, 0, s * stretch, 0, 1, 0, -s, 0, c * stretch;
    return j;
  }

  // Lines along z become arcs: their ends, and where an arc turns back along an axis.
  Box bounds(std::span<const double> p, double zHalf_m, const Box& box) const override {
    if (p[0] == 0) return box;
    const double k = p[0] / (2 * zHalf_m);
    const double low = std::max(box.low.z(), -zHalf_m), high = std::min(box.high.z(), zHalf_m);
    Box image;
    for (const double x : {box.low.x(), box.high.x()}) {
      image.add(forward(p, zHalf_m, {x, box.low.y(), box.low.z()}));
      image.add(forward(p, zHalf_m, {x, box.low.y(), box.high.z()}));
      // At quarter turns; |k z| <= π/2, so that there are no more.
      for (const double z : {-0.5 * kPi / k, 0.0, 0.5 * kPi / k})
        if (z > low && z < high) image.add(forward(p, zHalf_m, {x, box.low.y(), z}));
    }
    image.high.y() = box.high.y();
    return image;
  }

  double invertibleAmount(std::span<const double> p, double zHalf_m,
                          const Box& box) const override {
    const double limit = (1 - kLeastStretch) * 2 * zHalf_m / std::max(reachAlongX(box), 1e-9);
    const double amount = std::clamp(p[0], -limit, limit);
    return std::abs(amount) < 1e-6 ? 0 : amount;  // 1e-6 rad is below the resolution of float
  }
  DeformationKernel kernel(std::span<const double> p, double zHalf_m, const Box&) const override {
    return {DeformationKernel::Kind::bend, static_cast<float>(zHalf_m),
            static_cast<float>(p[0] / (2 * zHalf_m))};
  }

 private:
  static double reachAlongX(const Box& box) {
    return std::max(std::abs(box.low.x()), std::abs(box.high.x()));
  }
};

}  // namespace

const Deformation& bendDeformation() {
  static const BendDeformation kDeformation;
  return kDeformation;
}

}  // namespace fascia
