#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

namespace fascia {

// Files cut a surface into more vertices than it has points: along UV seams, hard edges, borders of
// materials. Which vertices are one point?
struct Weld {
  std::vector<std::uint32_t> point;  // per vertex
  std::uint32_t pointCount = 0;      // numbered in the order of their first vertices
};

// Joins vertices along edges: where a border of the surface runs along another border at the same
// positions (within `tolerance`), the two ends of the edge are joined, if both pairs are `alike`.
// A vertex is never joined for lying at the same place alone: the two sides of a wing that was
// modelled as coincident sheets stay two sheets, and two bodies that touch stay two. Where more
// than two borders run along an edge, those are joined first whose triangles continue each other
// most evenly; a triangle is never joined to one that lies folded back onto it. Vertices without
// triangles join those at their place.
Weld weldVertices(std::span<const Eigen::Vector3f> positions,
                  std::span<const std::array<std::uint32_t, 3>> triangles, float tolerance,
                  const std::function<bool(std::uint32_t, std::uint32_t)>& alike);

// Numbers the connected pieces in the order of their first points; returns how many there are.
std::uint32_t numberComponents(std::size_t pointCount,
                               std::span<const std::array<std::uint32_t, 3>> triangles,
                               std::vector<std::uint32_t>& component);

// Two corners are one point, or the triangle is a line: its height is below a millionth of its
// longest side, so that no direction in its plane can be told.
bool isDegenerate(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c);

}  // namespace fascia
