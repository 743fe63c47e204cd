#include <fascia/geometry/triangle_mesh.h>

#include <fascia/base/assert.h>

namespace fascia {

void computeNormals(const std::vector<Eigen::Vector3f>& positions,
                    const std::vector<std::array<std::uint32_t, 3>>& triangles,
                    std::vector<Eigen::Vector3f>& normals) {
  normals.assign(positions.size(), Eigen::Vector3f::Zero());
  for (const auto& [a, b, c] : triangles) {
    FASCIA_ASSERT(a < positions.size() && b < positions.size() && c < positions.size(),
                  "corners are points of the mesh");
    // Twice the area times the unit normal: the weighting comes for free.
    const Eigen::Vector3f cross = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    for (const std::uint32_t corner : {a, b, c}) normals[corner] += cross;
  }
  for (Eigen::Vector3f& normal : normals) {
    const float largest = normal.cwiseAbs().maxCoeff();
    // Scaled first: the square of a small triangle's area underflows.
    normal = largest > 0 ? (normal / largest).normalized() : Eigen::Vector3f::UnitY();
  }
}

// Sum of the signed tetrahedra to a point near the mesh, which keeps the rounding small.
std::vector<std::array<std::uint32_t, 2>> edgesBothWays(
    std::span<const std::array<std::uint32_t, 3>> triangles) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  edges.reserve(6 * triangles.size());
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      edges.push_back({t[k], t[(k + 1) % 3]});
      edges.push_back({t[(k + 1) % 3], t[k]});
    }
  std::sort(edges.begin(), edges.end());
  return edges;
}

double enclosedVolume(const TriangleMesh& mesh) {
  if (mesh.positions.empty()) return 0;
  const Vec3 origin = mesh.positions.front().cast<double>();
  double sixfold = 0;
  for (const auto& triangle : mesh.triangles) {
    FASCIA_ASSERT(areBelow(triangle, mesh.positions.size()), "corners are points of the mesh");
    const Vec3 a = mesh.positions[triangle[0]].cast<double>() - origin;
    const Vec3 b = mesh.positions[triangle[1]].cast<double>() - origin;
    const Vec3 c = mesh.positions[triangle[2]].cast<double>() - origin;
    sixfold += a.dot(b.cross(c));
  }
  return sixfold / 6;
}

}  // namespace fascia
