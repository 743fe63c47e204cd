#pragma once

#include <span>

#include <fascia/deformable/bases/basis.h>
#include <fascia/deformable/matter/quadrature.h>
#include <fascia/field/solid.h>
#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// Where a body's mass and its elastic material are. Mass enters by ∫ ρ p pᵀ, a polynomial of twice
// the basis' degree, material by an energy that must be summed with positive weights; so there are
// two quadratures, each made for its own.
struct Matter {
  Quadrature mass;    // weights in kg
  Quadrature volume;  // weights in m³ (m² in two dimensions), all positive
};

// How fine the quadratures of a basis have to be. The strain energy's density is a polynomial of
// degree 4 in ∂x/∂X, so of degree 4 (degree − 1) in X; its volume term of 6, which is left to
// converge with the number of points. Up to degree 8 the energy is exact; beyond, its points are
// those of fittedQuadrature(), within 1 % of all that were sampled.
struct MatterDetail {
  int mass_degree, energy_degree;
  Basis::Degrees slopes;  // of ∂p/∂X

  static MatterDetail of(const Basis& basis) {
    return {2 * basis.degree(), 4 * (basis.degree() - 1), basis.slopeDegrees()};
  }
  static MatterDetail of(int basisDegree) {  // of all polynomials up to this degree
    const int slope = basisDegree - 1;
    return {2 * basisDegree, 4 * slope, {Eigen::Vector3i::Constant(slope), slope}};
  }
};

// All of these throw Error for lengths, masses or densities that are not positive and finite.

// Point masses; the volume is shared in proportion to the masses.
Matter pointMatter(std::span<const Vec3> points_m, std::span<const double> masses_kg,
                   double volume_m3);
// A box (in two dimensions its x–y rectangle, density in kg/m²); exact.
Matter boxMatter(int dimension, const Box& box, double density_kg_per_m3, MatterDetail detail);
// The inside of a simple polygon; exact. Throws Error as checkSimplePolygon() does.
Matter outlineMatter(std::span<const Vec2> outline_m, double density_kg_per_m2,
                     MatterDetail detail);
// The inside of a closed mesh, the mass exact, the energy sampled in columns cell_m wide.
Matter meshMatter(const TriangleMesh& mesh, double density_kg_per_m3, double cell_m,
                  MatterDetail detail);
// The inside of an implicit solid around its own origin, both sampled on a grid of cell_m; error
// O(cell²). In the solid's undeformed frame a skin over it sees the same shape.
Matter solidMatter(const Solid& solid, double density_kg_per_m3, double cell_m,
                   MatterDetail detail);

}  // namespace fascia
