#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <fascia/base/error.h>
#include <fascia/field/field.h>
#include <fascia/flesh/flesh.h>
#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// How well a skin's rest shape holds the flesh that it was laid around.
struct SkinFit {
  std::vector<SolidId> outside;  // solids that are not inside; increasing
  std::size_t crossings = 0;     // pairs of triangles that pass through each other
};

// `surface`: closed, as it is drawn; vertices at one place are one point. A solid is outside if its
// middle, or two of eight places halfway from there to its surface, lie where the surface does not
// wind around them.
SkinFit findSkinFit(const MovingField& flesh, const TriangleMesh& surface);

// Tells a person what is left outside, and what to use instead. `isTube`: the skin is a grid.
void warnOfSkinFit(const SkinFit& fit, const Flesh& flesh, bool isTube, const std::string& pointer,
                   Diagnostics& diagnostics);

}  // namespace fascia
