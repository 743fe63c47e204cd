#include <fascia/world/inflate.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/aligned.h>
#include <fascia/geometry/welded_normals.h>

namespace fascia {
namespace {

// How far each point is from the outline, m; 0 on it.
FloatArray depths(const BodySurface& plate, const std::vector<Eigen::Vector3f>& at) {
  const std::size_t count = at.size();
  VectorArray points(count), normals(count);
  FloatArray distance(count);
  for (std::size_t i = 0; i < count; ++i) points.x[i] = at[i].x(), points.y[i] = at[i].y();
  points.z.assign(count, 0);
  plate.evaluate(view(points, 0, count), distance.data(), view(normals, 0, count));
  for (float& d : distance) d = std::max(-d, 0.f);
  return distance;
}

// The depth where the plate is widest; where that is, no vertex need be.
float greatestDepth(const BodySurface& plate, const TriangleMesh& mesh) {
  std::vector<Eigen::Vector3f> samples = mesh.positions;
  for (const auto& [a, b, c] : mesh.triangles)
    samples.emplace_back((mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) / 3);
  const FloatArray depth = depths(plate, samples);
  return std::max(*std::ranges::max_element(depth), 1e-9f);
}

}  // namespace

void inflate(const BodySurface& plate, TriangleMesh& mesh) {
  const FloatArray depth = depths(plate, mesh.positions);
  const float widest = greatestDepth(plate, mesh);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float fromMiddle = 1 - std::min(depth[i] / widest, 1.f);
    mesh.positions[i].z() *= std::sqrt(1 - fromMiddle * fromMiddle);
  }
  WeldedNormals(mesh).compute(mesh.positions, mesh.normals);
}

}  // namespace fascia
