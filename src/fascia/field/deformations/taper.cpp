#include <algorithm>
#include <array>
#include <cmath>

#include <fascia/field/registry.h>

#include <fascia/base/assert.h>

namespace fascia {

namespace {

constexpr std::array<ParameterInfo, 1> kTaperParameters{
    {{"amount", 0, -0.95, 0.95, "the +z end grows by this share, the -z end shrinks by it"}}};

// Barr 1984, §3.2, tapering along z with r = f(z) = 1 + amount z / zHalf:
//   X = f x, Y = f y, Z = z.
class TaperDeformation final : public Deformation {
 public:
  std::string_view name() const override { return "taper"; }
  std::span<const ParameterInfo> parameters() const override { return kTaperParameters; }
  Vec3 forward(std::span<const double> p, double zHalf_m, const Vec3& x) const override {
    FASCIA_ASSERT(!p.empty() && zHalf_m > 0, "a deformation acts along a length");
    const double f = scale(p, zHalf_m, x.z());
    return {f * x.x(), f * x.y(), x.z()};
  }
  Vec3 inverse(std::span<const double> p, double zHalf_m, const Vec3& x) const override {
    FASCIA_ASSERT(!p.empty() && zHalf_m > 0, "a deformation acts along a length");
    const double f = scale(p, zHalf_m, x.z());
    return {x.x() / f, x.y() / f, x.z()};
  }
  Mat3 jacobian(std::span<const double> p, double zHalf_m, const Vec3& x) const override {
    const double f = scale(p, zHalf_m, x.z());
    const double slope = std::abs(x.z()) <= zHalf_m ? p[0] / zHalf_m : 0;
    Mat3 j;
    j << f, 0, slope * x.x(), 0, f, slope * x.y(), 0, 0, 1;
    return j;
  }
  Box bounds(std::span<const double> p, double zHalf_m, const Box& box) const override {
    const double f = std::max(scale(p, zHalf_m, box.low.z()), scale(p, zHalf_m, box.high.z()));
    Box image = box;
    for (int axis : {0, 1}) {
      image.low[axis] = std::min(box.low[axis], f * box.low[axis]);
      image.high[axis] = std::max(box.high[axis], f * box.high[axis]);
    }
    return image;
  }
  double invertibleAmount(std::span<const double> p, double, const Box&) const override {
    return p[0];
  }
  // Far away the map is steep, its tangent plane is not.
  Vec3 tangentPoint(const Vec3& x, const Box& box) const override {
    const double reach_m = reach(box);
    return {std::clamp(x.x(), -reach_m, reach_m), std::clamp(x.y(), -reach_m, reach_m), x.z()};
  }
  DeformationKernel kernel(std::span<const double> p, double zHalf_m,
                           const Box& box) const override {
    return {DeformationKernel::Kind::taper, static_cast<float>(zHalf_m),
            static_cast<float>(p[0] / zHalf_m), static_cast<float>(reach(box))};
  }

 private:
  static double reach(const Box& box) {
    return std::max({-box.low.x(), box.high.x(), -box.low.y(), box.high.y()});
  }
  static double scale(std::span<const double> p, double zHalf_m, double z) {
    return 1 + p[0] * std::clamp(z / zHalf_m, -1.0, 1.0);
  }
};

}  // namespace

const Deformation& taperDeformation() {
  static const TaperDeformation kDeformation;
  return kDeformation;
}

}  // namespace fascia
