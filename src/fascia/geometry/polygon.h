#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/math/types.h>

namespace fascia {

// Polygons in the plane, given by their corners in order, the last joined to the first.

// Positive if the corners go counter-clockwise.
double signedArea(std::span<const Vec2> polygon_m);

// Throws Error unless the polygon has at least three corners, all finite, an area, and edges that
// meet in the corners between neighbours only. Names the edges that meet elsewhere: edge i starts
// at corner i.
void checkSimplePolygon(std::span<const Vec2> polygon_m);

using PlanarTriangles = std::vector<std::array<std::uint32_t, 3>>;

// Triangles between the corners of a simple polygon, all of them used, counter-clockwise whatever
// the polygon's sense (ear clipping, Meisters 1975).
PlanarTriangles triangulatePolygon(std::span<const Vec2> polygon_m);

// A triangulation whose edges are at most `edge_m` long.
struct PlanarMesh {
  std::vector<Vec2> positions_m;  // the given ones first
  PlanarTriangles triangles;      // counter-clockwise
};

// Halves long edges, borders included, and flips edges so that triangles are as even as they can
// be (Lawson 1977: Delaunay but for the borders).
PlanarMesh refined(std::span<const Vec2> positions_m, PlanarTriangles triangles, double edge_m);

}  // namespace fascia
