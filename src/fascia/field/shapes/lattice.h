#pragma once

#include <functional>

#include <fascia/geometry/triangle_mesh.h>
#include <fascia/math/types.h>

namespace fascia {

struct SurfacePoint {
  Vec3 position_m, normal;
};

// A closed mesh of a star-shaped surface, from its points along the directions of a globe with
// `detail` segments around and about half as many from pole to pole (z is up). The column of the
// seam and the poles are repeated for their uv. `surface` is given each unit direction and whether
// it belongs to the upper half: the equator is visited from both sides when `splitEquator` is set.
TriangleMesh latticeSurface(
    int detail, bool splitEquator,
    const std::function<SurfacePoint(const Vec3& direction, bool upper)>& surface);

}  // namespace fascia
