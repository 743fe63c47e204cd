#pragma once

#include <span>
#include <vector>

#include <fascia/deformable/bases/basis.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/math/types.h>

namespace fascia {

// Points and weights (m³; m² in two dimensions): Σ w f(X) stands for ∫ f dX.
struct Quadrature {
  std::vector<Vec3> points_m;
  std::vector<double> weights;

  void add(const Vec3& point_m, double weight) {
    points_m.push_back(point_m), weights.push_back(weight);
  }
  std::size_t size() const { return points_m.size(); }
  double total() const;
};

// Nodes and weights on [0, 1] that integrate polynomials up to degree 2 count − 1 exactly
// (Gauss & Legendre; the nodes by Newton's method, Numerical Recipes §4.6). count in [1, 64].
struct LineRule {
  std::vector<double> nodes, weights;
};
LineRule gaussRule(int count);
LineRule gaussRuleOfDegree(int degree);

// Exact for polynomials up to `degree` in each coordinate over the box (its x–y rectangle).
Quadrature boxQuadrature(int dimension, const Box& box, int degree);

// The same over the inside of a simple polygon in the plane z = 0. By signed triangles from its
// first corner; weights have both signs, and points lie outside too.
Quadrature polygonQuadrature(std::span<const Vec2> polygon_m, int degree);
// By the triangles of triangulatePolygon(): more points, all of them inside, all weights positive.
Quadrature triangulatedQuadrature(std::span<const Vec2> polygon_m, int degree);

// Exact for polynomials up to the total `degree` over the inside of a closed mesh: every triangle
// and the origin span a tetrahedron whose sign is the side that the triangle faces (the divergence
// theorem); so weights have both signs, and points lie outside of the body too. For polynomials.
Quadrature closedMeshQuadrature(const TriangleMesh& mesh, int degree);

// Points inside of a closed mesh with positive weights: Gauss points on what each of the columns
// of a grid with cells of edge cell_m has inside. Converges with the grid; for any function.
Quadrature sampledMeshQuadrature(const TriangleMesh& mesh, double cell_m, int degree);

// The same integrals of polynomials up to the total `degree` with as few points as there are such
// polynomials, taken from the given ones, all weights positive if the given were (Carathéodory and
// Tchakaloff; Piazzon, Sommariva & Vianello 2017, "Caratheodory–Tchakaloff subsampling").
Quadrature reducedQuadrature(const Quadrature& rule, int dimension, int degree);

// Far fewer points for products of functions of these degrees: places and weights are fitted, so
// that moments of `rule` stay. Products of three are integrated to some thousandths of the whole,
// products of four nearly so; where `rule` is not symmetric and there are many, at least those of
// two. All weights are positive, all points within the box around those of `rule`. Takes up to
// seconds; gives `rule` back if it has few points, or no fit is found.
Quadrature fittedQuadrature(const Quadrature& rule, int dimension, const Basis::Degrees& degrees);

}  // namespace fascia
