#pragma once

#include <span>

#include <fascia/fitting/fitted_solid.h>
#include <fascia/fitting/rest_surface.h>

namespace fascia {

// Per joint: pieces of the mesh that count for nothing there.
using WornPieces = std::vector<std::vector<std::uint32_t>>;

// Writes coverage and deepest_outside_m of every joint, and the totals. `solidJoint`: whose the
// solids are.
void measureFit(const RestSurface& surface, std::span<const FittedSolid> solids,
                std::span<const std::size_t> solidJoint, const WornPieces& worn, FleshFit& fit);

}  // namespace fascia
