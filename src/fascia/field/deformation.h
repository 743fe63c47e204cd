#pragma once

#include <span>
#include <string_view>

#include <fascia/field/kernels.h>
#include <fascia/field/shape.h>
#include <fascia/math/types.h>

namespace fascia {

// A global deformation of space along the local z axis (Barr 1984), exactly invertible where the
// solid is. It acts over z in [-zHalf_m, zHalf_m], the undeformed shape's; beyond that it continues
// as the map of the nearer end. The first parameter is its amount; amount 0 is the identity.
class Deformation {
 public:
  virtual ~Deformation() = default;
  virtual std::string_view name() const = 0;  // "taper", "twist", "bend"
  virtual std::span<const ParameterInfo> parameters() const = 0;
  virtual Vec3 forward(std::span<const double> p, double zHalf_m, const Vec3& x) const = 0;
  virtual Vec3 inverse(std::span<const double> p, double zHalf_m, const Vec3& x) const = 0;
  // Of forward, at the undeformed point x.
  virtual Mat3 jacobian(std::span<const double> p, double zHalf_m, const Vec3& x) const = 0;
  // A box around the image of `box`.
  virtual Box bounds(std::span<const double> p, double zHalf_m, const Box& box) const = 0;
  // The amount nearest to the wanted one for which the map is one-to-one on `box`.
  virtual double invertibleAmount(std::span<const double> p, double zHalf_m,
                                  const Box& box) const = 0;
  // Where, for distances at x, the Jacobian is taken: the surface lies within `box`.
  virtual Vec3 tangentPoint(const Vec3& x, const Box&) const { return x; }
  // What evaluation needs of the deformation of what lies within `box`.
  virtual DeformationKernel kernel(std::span<const double> p, double zHalf_m,
                                   const Box& box) const = 0;
};

}  // namespace fascia
