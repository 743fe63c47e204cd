#pragma once

#include <cstdint>
#include <vector>

#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// Smooth normals of a mesh whose vertices repeat along a texture seam: vertices that lie on the
// same point at first share one normal for ever, so that the seam does not show.
class WeldedNormals {
 public:
  explicit WeldedNormals(const TriangleMesh& mesh);
  // Area-weighted, unit; +y where undefined. `normals` has as many entries as `positions`.
  void compute(const std::vector<Eigen::Vector3f>& positions,
               std::vector<Eigen::Vector3f>& normals) const;

 private:
  std::vector<std::uint32_t> weld_;  // vertex -> the first vertex at its place
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace fascia
