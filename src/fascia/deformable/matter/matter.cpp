#include <fascia/deformable/matter/matter.h>

#include <algorithm>
#include <cmath>
#include <string>

#include <fascia/base/error.h>
#include <fascia/geometry/polygon.h>

namespace fascia {
namespace {

void checkPositive(const char* what, double found) {
  if (found > 0 && std::isfinite(found)) return;
  Issue issue{{},
              "matter: " + std::string(what) + ": found " + std::to_string(found) +
                  ", expected a positive number",
              {}};
  throw Error(issue);
}

Quadrature scaled(Quadrature rule, double factor) {
  for (double& w : rule.weights) w *= factor;
  return rule;
}

// Few points make fast bodies; no more are needed than the energy's polynomials. Of high degrees
// there are too many for that: 969 of degree 16.
constexpr int kMostExactDegree = 8;

Quadrature reducedVolume(const Quadrature& rule, int dimension, const MatterDetail& detail) {
  return detail.energy_degree <= kMostExactDegree
             ? reducedQuadrature(rule, dimension, detail.energy_degree)
             : fittedQuadrature(rule, dimension, detail.slopes);
}

}  // namespace

Matter pointMatter(std::span<const Vec3> points_m, std::span<const double> masses_kg,
                   double volume_m3) {
  checkPositive("volume_m3", volume_m3);
  if (points_m.size() != masses_kg.size() || points_m.empty()) {
    Issue issue{{},
                "matter: found " + std::to_string(points_m.size()) + " points and " +
                    std::to_string(masses_kg.size()) + " masses, expected as many, at least one",
                {}};
    throw Error(issue);
  }
  Matter matter;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    checkPositive("mass (kg)", masses_kg[i]);
    matter.mass.add(points_m[i], masses_kg[i]);
  }
  matter.volume = scaled(matter.mass, volume_m3 / matter.mass.total());
  return matter;
}

Matter boxMatter(int dimension, const Box& box, double density_kg_per_m3, MatterDetail detail) {
  checkPositive("density_kg_per_m3", density_kg_per_m3);
  for (int axis = 0; axis < dimension; ++axis) checkPositive("edge (m)", box.size()[axis]);
  const Quadrature rule = boxQuadrature(dimension, box, detail.energy_degree);
  return {scaled(boxQuadrature(dimension, box, detail.mass_degree), density_kg_per_m3),
          detail.energy_degree <= kMostExactDegree
              ? rule
              : fittedQuadrature(rule, dimension, detail.slopes)};
}

Matter outlineMatter(std::span<const Vec2> outline_m, double density_kg_per_m2,
                     MatterDetail detail) {
  checkPositive("density_kg_per_m2", density_kg_per_m2);
  checkSimplePolygon(outline_m);
  return {scaled(polygonQuadrature(outline_m, detail.mass_degree), density_kg_per_m2),
          reducedVolume(triangulatedQuadrature(outline_m, detail.energy_degree), 2, detail)};
}

Matter meshMatter(const TriangleMesh& mesh, double density_kg_per_m3, double cell_m,
                  MatterDetail detail) {
  checkPositive("density_kg_per_m3", density_kg_per_m3);
  checkPositive("cell_m", cell_m);
  Matter matter;
  matter.mass = scaled(closedMeshQuadrature(mesh, detail.mass_degree), density_kg_per_m3);
  checkPositive("mass of the mesh (kg; is it closed, its triangles turned outward?)",
                matter.mass.total());
  const Quadrature samples = sampledMeshQuadrature(mesh, cell_m, detail.energy_degree);
  checkPositive("volume found in columns of cell_m (m3)", samples.total());
  matter.volume = reducedVolume(samples, 3, detail);
  // The samples' volume is off by what the columns miss; the exact one is known.
  const double exact_m3 = matter.mass.total() / density_kg_per_m3;
  matter.volume = scaled(matter.volume, exact_m3 / samples.total());
  return matter;
}

Matter solidMatter(const Solid& solid, double density_kg_per_m3, double cell_m,
                   MatterDetail detail) {
  checkPositive("density_kg_per_m3", density_kg_per_m3);
  checkPositive("cell_m", cell_m);
  const Box& box = solid.bounds();
  const Eigen::Vector3i cells = (box.size() / cell_m).array().ceil().cast<int>().max(1);
  const Vec3 low = box.center() - 0.5 * cell_m * cells.cast<double>();
  const auto row = static_cast<std::size_t>(cells.x());
  VectorArray points(row), normals(row);
  FloatArray distance_m(row);
  Quadrature samples;
  for (int k = 0; k < cells.z(); ++k) {
    for (int j = 0; j < cells.y(); ++j) {
      const auto centerOf = [&](std::size_t i) -> Vec3 {
        return low + cell_m * Vec3(static_cast<double>(i) + 0.5, j + 0.5, k + 0.5);
      };
      for (std::size_t i = 0; i < row; ++i) {
        const Eigen::Vector3f center = centerOf(i).cast<float>();
        points.x[i] = center.x(), points.y[i] = center.y(), points.z[i] = center.z();
      }
      solid.evaluate(view(points, 0, row), distance_m.data(), view(normals, 0, row));
      for (std::size_t i = 0; i < row; ++i) {
        // A cell that the surface cuts counts with the part that a plane would leave inside.
        const double share = std::clamp(0.5 - distance_m[i] / cell_m, 0.0, 1.0);
        if (share > 0) samples.add(centerOf(i), share * cell_m * cell_m * cell_m);
      }
    }
  }
  checkPositive("volume found in cells of cell_m (m3)", samples.total());
  return {scaled(samples, density_kg_per_m3), reducedVolume(samples, 3, detail)};
}

}  // namespace fascia
