#pragma once

#include <fascia/deformable/surfaces/body_surface.h>

namespace fascia {

// Turns the mesh of a plate in the plane z = 0 into that of a cushion with the same outline: its
// rim is round, half a circle of the plate's thickness; where it is narrower than that it is
// thinner.
void inflate(const BodySurface& plate, TriangleMesh& mesh);

}  // namespace fascia
