#include <array>

#include <fascia/field/registry.h>
#include <fascia/field/shapes/superquadric.h>

namespace fascia {

namespace {

constexpr std::array<ParameterInfo, 5> kSuperellipsoidParameters{
    {{"half_x_m", 0.1, 1e-4, 100, "half size along x"},
     {"half_y_m", 0.1, 1e-4, 100, "half size along y"},
     {"half_z_m", 0.1, 1e-4, 100, "half size along z"},
     {"exponent_e1", 1, 0.1, 2, "north to south: 0.1 flat ends, 1 round, 2 pointed ends"},
     {"exponent_e2", 1, 0.1, 2, "around z: 0.1 square, 1 round, 2 diamond"}}};

}  // namespace

const Shape& superellipsoidShape() {
  static const SuperquadricShape kShape("superellipsoid", kSuperellipsoidParameters);
  return kShape;
}

}  // namespace fascia
