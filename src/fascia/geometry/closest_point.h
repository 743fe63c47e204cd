#pragma once

#include <fascia/math/types.h>

namespace fascia {

struct TrianglePoint {
  Vec3 position;
  Vec3 weights;  // barycentric: of the corners a, b, c; each in [0, 1], sum 1
};

// The point of a triangle that is nearest to p. Triangles without area count as their edges.
TrianglePoint closestPointOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace fascia
