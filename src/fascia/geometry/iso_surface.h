#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/math/types.h>

namespace fascia {

// A closed surface as the zero of a function of space that is negative inside. Whoever makes one
// decides what it is a function of.
struct ImplicitSurface {
  // Writes value (m) and gradient of each point. May be called by several threads at once; what it
  // says of a point must not depend on the others.
  std::function<void(ConstVectors points, float* value, Vectors gradient)> evaluate;
  Box bounds_m;          // the function is positive on its faces and outside
  double lipschitz = 1;  // |f(p) - f(q)| <= lipschitz |p - q|
};

// The surface as triangles, by marching tetrahedra: every cube of a grid is cut into six
// tetrahedra, the same way as its neighbours (Kuhn), so that the result is closed and 2-manifold
// for any function whatsoever. Parts much smaller than a cube are missed, and sheets nearer to each
// other than that can be joined. No two vertices lie on one place; triangles are of all sizes: see
// remesh.h. Surfaces around hollows that are closed all around are left out. cell_m is made larger
// where more than kMostCells cubes would be needed.
TriangleMesh isoSurface(const ImplicitSurface& surface, double cell_m);
inline constexpr double kMostCells = 1 << 24;

// Points along the gradient onto the surface, as far as the function leads there: no farther than
// most_m each.
void projectOnto(const ImplicitSurface& surface, double most_m, std::span<Vec3> points);

}  // namespace fascia
