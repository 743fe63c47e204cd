#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

using TriangleList = std::span<const std::array<std::uint32_t, 3>>;
using PointList = std::span<const Eigen::Vector3f>;

// How good a deformation is; every measure is a closed definition that its test checks on a shape
// with a known answer. Metres. See docs/deformation.md.

// Pairs of triangles that cross each other without sharing a point.
std::size_t crossingTrianglePairs(TriangleList triangles, PointList points);

// Largest and 99th percentile of edge length over rest length.
struct EdgeStretch {
  double largest, percentile99;
};
EdgeStretch edgeStretch(TriangleList triangles, PointList rest, PointList points);

// Volume enclosed by the surface between a cut on either side of a joint …: see the helper's docs.

}  // namespace fascia
