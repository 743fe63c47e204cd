#pragma once

#include <fascia/fitting/fitted_solid.h>
#include <fascia/fitting/rest_surface.h>
#include <fascia/fitting/solid_fitting.h>

namespace fascia {

// How far a solid and the skin pass through each other: skin points within the solid, or points of
// the solid outside of the skin. 0: the solid is inside.
double deepestOutside_m(const RestSurface& surface, const FittedSolid& solid);

// Makes the solid thinner until nothing of it is nearer to the skin than `margin_m`. With a
// symmetry plane its image must stay inside too. False if less than about half of it would be left.
bool shrinkInside(const RestSurface& surface, const MirrorPlane* plane, double margin_m,
                  FittedSolid& solid);

// The target's best solid that keeps the margin: fits, turns what it violates into bounds, fits
// again, and at last shrinks. `solid` comes as the first guess.
bool fitInside(const RestSurface& surface, const MirrorPlane* plane, double margin_m,
               SolidTarget target, FittedSolid& solid);

}  // namespace fascia
