#include <fascia/render/curvature.h>

namespace fascia {

void vertexCurvature(const std::vector<Eigen::Vector3f>& positions,
                     const std::vector<Eigen::Vector3f>& normals,
                     const std::vector<std::array<std::uint32_t, 3>>& triangles,
                     std::vector<float>& curvature_per_m) {
  // Along an edge e between unit normals n0, n1 the normal curvature is (n1 - n0)·e / e·e. Each
  // vertex averages its edges weighted with e·e, which needs no division until the end.
  curvature_per_m.assign(positions.size(), 0.f);
  static thread_local std::vector<float> weight;
  weight.assign(positions.size(), 0.f);
  for (const auto& triangle : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangle[k], b = triangle[(k + 1) % 3];
      const Eigen::Vector3f edge = positions[b] - positions[a];
      const float bend = (normals[b] - normals[a]).dot(edge), length2 = edge.squaredNorm();
      curvature_per_m[a] += bend, curvature_per_m[b] += bend;
      weight[a] += length2, weight[b] += length2;
    }
  for (std::size_t i = 0; i < positions.size(); ++i)
    curvature_per_m[i] = weight[i] > 0 ? curvature_per_m[i] / weight[i] : 0.f;
}

}  // namespace fascia
