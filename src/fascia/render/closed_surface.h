#pragma once

#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// Whether a mesh is made of closed surfaces that all face outwards, so that from outside its back
// faces are hidden by its front faces. Points at the same place count as one: texture seams do not
// open a surface. False if a point is not finite.
bool facesOutwards(const TriangleMesh& mesh);

}  // namespace fascia
