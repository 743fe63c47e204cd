#pragma once

#include <span>
#include <string_view>

#include <fascia/field/shape.h>

namespace fascia {

// Barr's (1981) superellipsoid, shared by the shapes of its family:
//   (|x/a|^(2/e2) + |y/b|^(2/e2))^(e2/e1) + |z/c|^(2/e1) = 1.
struct Superquadric {
  Vec3 half_m = Vec3::Ones();  // a, b, c
  double northSouth_e1 = 1;    // [0.1, 2]: 0.1 nearly flat ends, 1 round, 2 conical
  double eastWest_e2 = 1;  // [0.1, 2]: the cross-section: 0.1 nearly square, 1 round, 2 a diamond
};

double volume_m3(const Superquadric& s);
double gauge(const Superquadric& s, const Vec3& x);
// Gradient of the gauge; constant along rays. At the origin and on creases one of its limits.
Vec3 gaugeGradient(const Superquadric& s, const Vec3& x);
PrimitiveKernel kernel(const Superquadric& s);
TriangleMesh tessellate(const Superquadric& s, int detail);

// A shape of the family; its parameters are half sizes, e1, e2.
class SuperquadricShape final : public Shape {
 public:
  SuperquadricShape(std::string_view name, std::span<const ParameterInfo, 5> parameters)
      : name_(name), parameters_(parameters) {}

  std::string_view name() const override { return name_; }
  std::span<const ParameterInfo> parameters() const override { return parameters_; }
  double volume_m3(std::span<const double> p) const override;
  Vec3 halfExtents_m(std::span<const double> p) const override;
  double gauge(std::span<const double> p, const Vec3& x) const override;
  TriangleMesh tessellate(std::span<const double> p, int detail) const override;
  PrimitiveKernel kernel(std::span<const double> p) const override;

 private:
  std::string_view name_;
  std::span<const ParameterInfo, 5> parameters_;
};

}  // namespace fascia
