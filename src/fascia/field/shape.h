#pragma once

#include <span>
#include <string_view>

#include <fascia/base/aligned.h>
#include <fascia/field/kernels.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/math/types.h>

namespace fascia {

// One tunable number of a shape or deformation.
struct ParameterInfo {
  std::string_view name;  // with its unit: "radius_m", "exponent_e1", "angle_rad"
  double standard;        // value if the file gives none
  double min, max;        // closed range
  std::string_view help;
};

// A convex primitive around its own origin, along its z axis where it has one (superquadrics: Barr
// 1981). Parameters come as a span in the order of parameters(), within their ranges.
class Shape {
 public:
  virtual ~Shape() = default;
  virtual std::string_view name() const = 0;  // as in files: "sphere"
  virtual std::span<const ParameterInfo> parameters() const = 0;
  virtual double volume_m3(std::span<const double> p) const = 0;  // closed form
  virtual Vec3 halfExtents_m(std::span<const double> p) const = 0;
  // 1 on the surface, less inside, and gauge(s x) = s gauge(x) for s >= 0 (Minkowski functional).
  virtual double gauge(std::span<const double> p, const Vec3& x) const = 0;
  // The surface as a closed mesh for display and export; `detail` = segments around, at least 3.
  virtual TriangleMesh tessellate(std::span<const double> p, int detail) const = 0;
  // What evaluation needs.
  virtual PrimitiveKernel kernel(std::span<const double> p) const = 0;

  // Signed distance estimate (m, negative inside) and outward unit normal at local points.
  void evaluate(std::span<const double> p, ConstVectors points, float* distance_m,
                Vectors normal) const;
};

}  // namespace fascia
