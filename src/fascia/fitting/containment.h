#pragma once

#include <fascia/fitting/body_surface.h>
#include <fascia/fitting/fitted_solid.h>

namespace fascia {

// How far a solid and the skin pass through each other: skin points within the solid, or points of
// the solid outside of the skin. 0: the solid is inside.
double deepestOutside_m(const BodySurface& surface, const FittedSolid& solid);

// Makes the solid thinner until nothing of it is nearer to the skin than about `margin_m`. With a
// symmetry plane its image counts too. False if next to nothing would be left.
bool shrinkInside(const BodySurface& surface, const MirrorPlane* plane, double margin_m,
                  FittedSolid& solid);

}  // namespace fascia
