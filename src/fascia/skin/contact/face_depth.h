#pragma once

#include <fascia/field/field.h>
#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// How deep the faces of a surface cut into the solids of a field, m ≥ 0. No place lies farther than
// 1/300 of the surface's size from where it was looked, and around the deepest one it was looked
// more closely.
double deepestFace(const DistanceField& field, const TriangleMesh& surface);

}  // namespace fascia
