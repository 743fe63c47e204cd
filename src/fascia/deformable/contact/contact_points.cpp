#include <fascia/deformable/contact/contact_points.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fascia {
namespace {

// Vertices nearer to each other, or to the surface, than this part of a body's size are as one.
constexpr double kSame = 1e-3;

// A plate's vertices are on its faces too; in the plane z = 0 those are inside.
std::vector<Vec3> outlinePoints(const BodySurface& surface, double size_m) {
  std::vector<Vec3> points;
  for (const Eigen::Vector3f& p : surface.mesh().positions) {
    const float x = p.x(), y = p.y(), z = 0;
    float distance_m, nx, ny, nz;
    surface.evaluate({&x, &y, &z, 1}, &distance_m, {&nx, &ny, &nz, 1});
    if (std::abs(distance_m) <= kSame * size_m) points.emplace_back(x, y, 0);
  }
  return points;
}

// The farthest vertices along the diagonals, then along the axes and between them: corners.
std::vector<std::size_t> extremePoints(const std::vector<Vec3>& vertices) {
  std::vector<std::size_t> extremes;
  if (vertices.empty()) return extremes;
  for (const int nonzero : {3, 2, 1}) {
    for (int code = 0; code < 27; ++code) {
      const int x = code % 3 - 1, y = code / 3 % 3 - 1, z = code / 9 - 1;
      const Vec3 direction(x, y, z);
      if ((direction.array() != 0).count() != nonzero) continue;
      const auto along = [&](const Vec3& p) { return direction.dot(p); };
      extremes.push_back(static_cast<std::size_t>(std::ranges::max_element(vertices, {}, along) -
                                                  vertices.begin()));
    }
  }
  return extremes;
}

double areaOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum +=
        0.5 *
        (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).norm();
  return sum;
}

}  // namespace

ContactPoints makeContactPoints(const BodyShape& shape, const BodySurface& surface,
                                std::size_t count) {
  std::vector<Vec3> vertices;
  if (shape.dimension() == 2) {
    vertices = outlinePoints(surface, shape.size_m());
  } else {
    for (const Eigen::Vector3f& p : surface.mesh().positions) vertices.push_back(p.cast<double>());
  }
  ContactPoints points;
  std::vector<double> distance_m(vertices.size(), std::numeric_limits<double>::infinity());
  const auto take = [&](std::size_t vertex) {
    if (points.size() >= count || distance_m[vertex] <= kSame * shape.size_m()) return false;
    points.X_m.push_back(vertices[vertex]);
    for (std::size_t i = 0; i < vertices.size(); ++i)
      distance_m[i] = std::min(distance_m[i], (vertices[i] - vertices[vertex]).norm());
    return true;
  };
  for (const std::size_t vertex : extremePoints(vertices)) take(vertex);
  const auto farthest = [&] {
    return static_cast<std::size_t>(std::ranges::max_element(distance_m) - distance_m.begin());
  };
  while (!vertices.empty() && take(farthest())) {
  }
  if (points.size() > 0)
    points.area_m2 = areaOf(surface.mesh()) / static_cast<double>(points.size());
  points.weights.resize(shape.shapeCount(), static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    points.weights.col(static_cast<Eigen::Index>(i)) = shape.pointWeights(points.X_m[i]);
  return points;
}

}  // namespace fascia
