#pragma once

#include <fascia/body/body_surface.h>

namespace fascia {

// Turns the mesh of a plate in the plane z = 0 into that of a cushion with the same outline: its
// thickness grows from nothing at the rim like a circle's, to that of the plate where it is widest.
void inflate(const BodySurface& plate, TriangleMesh& mesh);

}  // namespace fascia
