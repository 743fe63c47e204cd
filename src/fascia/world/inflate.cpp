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

}  // namespace

void inflate(const BodySurface& plate, TriangleMesh& mesh) {
  const FloatArray depth = depths(plate, mesh.positions);
  const auto half_m = static_cast<float>(0.5 * plate.bounds_m().size().z());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float fromTop = 1 - std::min(depth[i] / half_m, 1.f);
    mesh.positions[i].z() *= std::sqrt(1 - fromTop * fromTop);
  }
  WeldedNormals(mesh).compute(mesh.positions, mesh.normals);
}

}  // namespace fascia
