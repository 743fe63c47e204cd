#pragma once

#include <fascia/geometry/iso_surface.h>

namespace fascia {

struct RemeshOptions {
  double edge_m = 0.02;  // how long edges are to be
  // Where the surface is curved they are shorter: no longer than so many radians of the arc, and no
  // shorter than this share of edge_m.
  double arc_rad = 0.65;
  double finest = 0.6;
  int rounds = 8;
};

// Even triangles on a surface: edges that are too long are split, those that are too short
// collapsed, others flipped so that six meet in a point, and points are moved along the surface to
// the middle of their neighbours (Botsch & Kobbelt 2004, "A Remeshing Approach to Multiresolution
// Modeling", §4), then put back onto it. `mesh`: closed and 2-manifold, on or near the surface, as
// isoSurface() makes it; so is the result, with as many pieces and holes.
TriangleMesh remeshed(const ImplicitSurface& surface, const TriangleMesh& mesh,
                      const RemeshOptions& options);

}  // namespace fascia
