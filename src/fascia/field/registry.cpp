#include <array>

#include <fascia/field/registry.h>
#include <fascia/field/solid.h>

namespace fascia {

std::span<const Shape* const> shapes() {
  static const std::array<const Shape*, 4> kAll{&sphereShape(), &superellipsoidShape(),
                                                &cylinderShape(), &capsuleShape()};
  return kAll;
}

std::span<const Deformation* const> deformations() {
  static const std::array<const Deformation*, 3> kAll{&taperDeformation(), &twistDeformation(),
                                                      &bendDeformation()};
  return kAll;
}

const Shape* findShape(std::string_view name) {
  for (const Shape* shape : shapes()) {
    if (shape->name() == name) return shape;
  }
  return nullptr;
}

const Deformation* findDeformation(std::string_view name) {
  for (const Deformation* deformation : deformations()) {
    if (deformation->name() == name) return deformation;
  }
  return nullptr;
}

}  // namespace fascia
