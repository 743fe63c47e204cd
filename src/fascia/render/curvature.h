#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace fascia {

// Mean of the normal curvatures along each vertex's edges, 1/m, positive where convex. A derivative
// in the shader would be constant per triangle and show the facets.
void vertexCurvature(const std::vector<Eigen::Vector3f>& positions,
                     const std::vector<Eigen::Vector3f>& normals,
                     const std::vector<std::array<std::uint32_t, 3>>& triangles,
                     std::vector<float>& curvature_per_m);

}  // namespace fascia
