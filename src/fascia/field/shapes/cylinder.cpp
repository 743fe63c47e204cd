#include <array>

#include <fascia/field/registry.h>
#include <fascia/field/shapes/superquadric.h>

namespace fascia {

namespace {

constexpr std::array<ParameterInfo, 5> kCylinderParameters{
    {{"half_x_m", 0.1, 1e-4, 100, "half size along x"},
     {"half_y_m", 0.1, 1e-4, 100, "half size along y"},
     {"half_z_m", 0.2, 1e-4, 100, "half size along z"},
     {"rounding", 0.2, 0.1, 1, "of the rims (exponent e1): 0.1 sharp, 1 an ellipsoid"},
     {"exponent_e2", 1, 0.1, 2, "around z: 0.1 square, 1 round, 2 diamond"}}};

}  // namespace

// Closed by flat ends with rounded rims: the superellipsoid of small e1.
const Shape& cylinderShape() {
  static const SuperquadricShape kShape("cylinder", kCylinderParameters);
  return kShape;
}

}  // namespace fascia
