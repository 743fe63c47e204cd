#pragma once

#include <fascia/fitting/body_surface.h>
#include <fascia/fitting/fitted_solid.h>
#include <fascia/fitting/solid_fitting.h>

namespace fascia {

// How far a solid and the skin pass through each other: skin points within the solid, or points of
// the solid outside of the skin. 0: the solid is inside.
double deepestOutside_m(const BodySurface& surface, const FittedSolid& solid);

// The target's best solid that keeps at least `margin_m` from the skin: fits, turns what it
// violates into bounds, fits again, and at last makes it thinner. With a symmetry plane its image
// must stay inside too. False if next to nothing would be left.
bool fitInside(const BodySurface& surface, const MirrorPlane* plane, double margin_m,
               SolidTarget target, FittedSolid& solid);

}  // namespace fascia
