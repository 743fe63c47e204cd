#include <fascia/deformable/matter/quadrature.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fascia/geometry/polygon.h>

namespace fascia {

double Quadrature::total() const {
  return std::accumulate(weights.begin(), weights.end(), 0.0);
}

LineRule gaussRule(int count) {
  LineRule rule{std::vector<double>(static_cast<std::size_t>(count)),
                std::vector<double>(static_cast<std::size_t>(count))};
  for (int i = 0; i < count; ++i) {
    double x = std::cos(kPi * (i + 0.75) / (count + 0.5)), slope = 1;
    for (int iteration = 0; iteration < 8; ++iteration) {
      double p = 1, before = 0;  // Legendre polynomials by their recurrence
      for (int n = 1; n <= count; ++n) {
        const double next = ((2 * n - 1) * x * p - (n - 1) * before) / n;
        before = p, p = next;
      }
      slope = count * (x * p - before) / (x * x - 1);
      x -= p / slope;
    }
    rule.nodes[static_cast<std::size_t>(i)] = 0.5 * (1 - x);
    rule.weights[static_cast<std::size_t>(i)] = 1 / ((1 - x * x) * slope * slope);
  }
  return rule;
}

LineRule gaussRuleOfDegree(int degree) {
  return gaussRule(std::max(1, (degree + 2) / 2));
}

Quadrature boxQuadrature(int dimension, const Box& box, int degree) {
  const LineRule line = gaussRuleOfDegree(degree);
  const LineRule flat{{0.0}, {1.0}};
  const LineRule& depth = dimension == 3 ? line : flat;
  const Vec3 size = box.size();
  const double volume = size.x() * size.y() * (dimension == 3 ? size.z() : 1);
  Quadrature rule;
  for (std::size_t k = 0; k < depth.nodes.size(); ++k) {
    for (std::size_t j = 0; j < line.nodes.size(); ++j) {
      for (std::size_t i = 0; i < line.nodes.size(); ++i) {
        const Vec3 u(line.nodes[i], line.nodes[j], depth.nodes[k]);
        Vec3 point = box.low + size.cwiseProduct(u);
        if (dimension == 2) point.z() = 0;
        rule.add(point, volume * line.weights[i] * line.weights[j] * depth.weights[k]);
      }
    }
  }
  return rule;
}

namespace {

// The square [0, 1]² is mapped onto the triangle by X = a + u (b − a + v (c − b)) with the
// determinant u times that of the sides, which adds 1 to the degree.
void addTriangle(const Vec2& a, const Vec2& b, const Vec2& c, double sign, const LineRule& line,
                 Quadrature& rule) {
  const Vec2 ab = b - a, ac = c - a;
  const double determinant = sign * (ab.x() * ac.y() - ab.y() * ac.x());
  if (determinant == 0) return;
  for (std::size_t i = 0; i < line.nodes.size(); ++i) {
    for (std::size_t j = 0; j < line.nodes.size(); ++j) {
      const double u = line.nodes[i], v = line.nodes[j];
      const Vec2 X = a + u * (ab + v * (c - b));
      rule.add(Vec3(X.x(), X.y(), 0), determinant * u * line.weights[i] * line.weights[j]);
    }
  }
}

}  // namespace

Quadrature polygonQuadrature(std::span<const Vec2> polygon_m, int degree) {
  const LineRule line = gaussRuleOfDegree(degree + 1);
  const double sign = signedArea(polygon_m) < 0 ? -1 : 1;
  Quadrature rule;
  for (std::size_t i = 1; i + 1 < polygon_m.size(); ++i)
    addTriangle(polygon_m[0], polygon_m[i], polygon_m[i + 1], sign, line, rule);
  return rule;
}

Quadrature triangulatedQuadrature(std::span<const Vec2> polygon_m, int degree) {
  const LineRule line = gaussRuleOfDegree(degree + 1);
  Quadrature rule;
  for (const auto& [a, b, c] : triangulatePolygon(polygon_m))
    addTriangle(polygon_m[a], polygon_m[b], polygon_m[c], 1, line, rule);
  return rule;
}

Quadrature closedMeshQuadrature(const TriangleMesh& mesh, int degree) {
  // The cube [0, 1]³ is mapped onto the tetrahedron by X = u (a + v (b − a + w (c − b))) with the
  // determinant u² v det[a b c] (Stroud's conical product), which adds 2 to the degree.
  const LineRule line = gaussRuleOfDegree(degree + 2);
  Quadrature rule;
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const Vec3 a = mesh.positions[ia].cast<double>(), b = mesh.positions[ib].cast<double>(),
               c = mesh.positions[ic].cast<double>();
    const double determinant = a.dot(b.cross(c));
    for (std::size_t i = 0; i < line.nodes.size(); ++i) {
      for (std::size_t j = 0; j < line.nodes.size(); ++j) {
        for (std::size_t k = 0; k < line.nodes.size(); ++k) {
          const double u = line.nodes[i], v = line.nodes[j], w = line.nodes[k];
          rule.add(u * (a + v * (b - a + w * (c - b))),
                   determinant * u * u * v * line.weights[i] * line.weights[j] * line.weights[k]);
        }
      }
    }
  }
  return rule;
}

namespace {

// Heights at which the vertical line over (x, y) crosses the mesh, sorted.
void crossings(const TriangleMesh& mesh, double x, double y, std::vector<double>& heights) {
  heights.clear();
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const Vec3 a = mesh.positions[ia].cast<double>(), b = mesh.positions[ib].cast<double>(),
               c = mesh.positions[ic].cast<double>();
    const Vec2 p(x, y), ab = (b - a).head<2>(), ac = (c - a).head<2>(), ap = p - a.head<2>();
    const double area = ab.x() * ac.y() - ab.y() * ac.x();
    if (area == 0) continue;
    const double s = (ap.x() * ac.y() - ap.y() * ac.x()) / area;
    const double t = (ab.x() * ap.y() - ab.y() * ap.x()) / area;
    if (s >= 0 && t >= 0 && s + t < 1) heights.push_back(a.z() + s * (b - a).z() + t * (c - a).z());
  }
  std::ranges::sort(heights);
}

}  // namespace

Quadrature sampledMeshQuadrature(const TriangleMesh& mesh, double cell_m, int degree) {
  // A little off the middle of its cell a column does not run along edges and through corners,
  // which would be counted twice.
  constexpr double kShiftX = 0.5 + 5.4772e-5, kShiftY = 0.5 + 4.5826e-5;
  Box box;
  for (const Eigen::Vector3f& p : mesh.positions) box.add(p.cast<double>());
  const Vec3 count = (box.size() / cell_m).array().ceil().max(1.0);
  const Vec3 cell = box.size().cwiseQuotient(count);
  Quadrature rule;
  std::vector<double> heights;
  for (double i = 0; i < count.x(); ++i) {
    for (double j = 0; j < count.y(); ++j) {
      const double x = box.low.x() + (i + kShiftX) * cell.x();
      const double y = box.low.y() + (j + kShiftY) * cell.y();
      crossings(mesh, x, y, heights);
      for (std::size_t n = 0; n + 1 < heights.size(); n += 2) {
        const double length = heights[n + 1] - heights[n];
        const int cells = static_cast<int>(std::min(length / cell.z(), 30.0));
        const LineRule line = gaussRuleOfDegree(std::max(degree, 2 * cells));
        for (std::size_t m = 0; m < line.nodes.size(); ++m)
          rule.add(Vec3(x, y, heights[n] + length * line.nodes[m]),
                   cell.x() * cell.y() * length * line.weights[m]);
      }
    }
  }
  return rule;
}

}  // namespace fascia
