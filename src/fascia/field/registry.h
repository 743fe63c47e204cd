#pragma once

#include <fascia/field/deformation.h>
#include <fascia/field/shape.h>

namespace fascia {

// Every shape and deformation that a file may name. A new one is its file, a line here and a line
// in registry.cpp.
const Shape& sphereShape();
const Shape& superellipsoidShape();
const Shape& cylinderShape();
const Shape& capsuleShape();

const Deformation& taperDeformation();
const Deformation& twistDeformation();
const Deformation& bendDeformation();

}  // namespace fascia
