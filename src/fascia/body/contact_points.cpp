#include <fascia/body/contact_points.h>

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
  const double same_m = kSame * shape.size_m();
  std::size_t next = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if ((vertices[i] - shape.center_m()).norm() > (vertices[next] - shape.center_m()).norm())
      next = i;
  while (points.size() < std::min(count, vertices.size()) && distance_m[next] > same_m) {
    points.X_m.push_back(vertices[next]);
    for (std::size_t i = 0; i < vertices.size(); ++i)
      distance_m[i] = std::min(distance_m[i], (vertices[i] - points.X_m.back()).norm());
    next = static_cast<std::size_t>(std::ranges::max_element(distance_m) - distance_m.begin());
  }
  points.weights.resize(shape.shapeCount(), static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    points.weights.col(static_cast<Eigen::Index>(i)) = shape.pointWeights(points.X_m[i]);
  return points;
}

}  // namespace fascia
