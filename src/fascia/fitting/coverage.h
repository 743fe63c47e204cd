#pragma once

#include <span>

#include <fascia/fitting/body_surface.h>
#include <fascia/fitting/fitted_solid.h>

namespace fascia {

// Writes coverage and deepest_outside_m of every joint, and the totals. `solidJoint`: whose the
// solids are.
void measureFit(const BodySurface& surface, std::span<const FittedSolid> solids,
                std::span<const std::size_t> solidJoint, FleshFit& fit);

}  // namespace fascia
