#pragma once

#include <memory>
#include <span>

#include <fascia/field/solid.h>
#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// Where a body ends: the surface of its undeformed matter. A deformed body is this surface seen
// through the body's map (body_field.h), so that one class serves all shapes that a body takes.
// Constant, and free to be shared by bodies of one kind.
class BodySurface {
 public:
  virtual ~BodySurface() = default;
  virtual Box bounds_m() const = 0;
  // Signed distance estimate (m, negative inside) and outward unit normal at undeformed points.
  // Reads and writes X.count entries; no alignment required. Never throws or allocates.
  virtual void evaluate(ConstVectors X, float* distance_m, Vectors normal) const = 0;
  // For pictures: closed, with normals; fine enough inside that bent bodies look smooth.
  virtual const TriangleMesh& mesh() const = 0;
};

using BodySurfacePtr = std::shared_ptr<const BodySurface>;

// A solid in its own frame; `detail` = segments of the mesh around it, at least 3.
BodySurfacePtr makeSolidSurface(const Solid& solid, int detail);
// A closed mesh, triangles counter-clockwise from outside; vertices at one place count as one.
// Distances are exact. Throws Error if an edge does not have two triangles, or if nothing is
// inside.
BodySurfacePtr makeMeshSurface(TriangleMesh mesh);
// A simple polygon in the plane z = 0, drawn as a plate between z = ± thickness_m / 2. Distances
// are exact. Throws Error as checkSimplePolygon() does, or if the thickness is not positive.
BodySurfacePtr makeOutlineSurface(std::span<const Vec2> outline_m, double thickness_m);

}  // namespace fascia
