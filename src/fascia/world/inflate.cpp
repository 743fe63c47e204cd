#include <fascia/world/inflate.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/aligned.h>
#include <fascia/geometry/welded_normals.h>

namespace fascia {
namespace {

// How far each vertex is from the outline, m; 0 on it.
FloatArray depths(const BodySurface& plate, const TriangleMesh& mesh) {
  const std::size_t count = mesh.positions.size();
  VectorArray points(count), normals(count);
  FloatArray distance(count);
  for (std::size_t i = 0; i < count; ++i)
    points.x[i] = mesh.positions[i].x(), points.y[i] = mesh.positions[i].y();
  points.z.assign(count, 0);
  plate.evaluate(view(points, 0, count), distance.data(), view(normals, 0, count));
  for (float& d : distance) d = std::max(-d, 0.f);
  return distance;
}

}  // namespace

void inflate(const BodySurface& plate, TriangleMesh& mesh) {
  const FloatArray depth = depths(plate, mesh);
  const float widest = std::max(*std::ranges::max_element(depth), 1e-9f);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float fromMiddle = 1 - depth[i] / widest;
    mesh.positions[i].z() *= std::sqrt(std::max(0.f, 1 - fromMiddle * fromMiddle));
  }
  WeldedNormals(mesh).compute(mesh.positions, mesh.normals);
}

}  // namespace fascia
