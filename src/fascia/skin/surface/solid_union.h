#pragma once

#include <fascia/field/field.h>
#include <fascia/geometry/iso_surface.h>

namespace fascia {

struct SolidUnionOptions {
  double fat_m = 0.01;  // how far outside of the solids
  double blend_m =
      0.02;  // radius of the fillet where two solids meet at a right angle; 0: a crease
};

// The surface around all solids together, at a distance of the fat: of the distances d_i to them
//
//   f = −k ln Σ exp(−d_i/k) − fat,   k = 0.42 blend,
//
// which is never more than the least of them, so that nothing of a solid is nearer to the surface
// than the fat. `flesh` must outlive it.
ImplicitSurface unionOfSolids(const DistanceField& flesh, const SolidUnionOptions& options);

}  // namespace fascia
