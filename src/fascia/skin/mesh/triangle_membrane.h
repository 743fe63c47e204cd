#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include <fascia/base/aligned.h>
#include <fascia/math/types.h>
#include <fascia/skin/mesh/hinge_bending.h>
#include <fascia/skin/point/stretch_limit.h>

namespace fascia {

// Material of a triangle mesh, one value per point in storage order, and a direction per triangle.
struct TriangleMaterial {
  FloatArray stretch_u, stretch_v, shear;  // N/m
  FloatArray bending;                      // Nm; may be empty
  FloatArray prestretch;                   // length in the rest shape over relaxed length
  std::vector<Eigen::Vector3f> u;          // per triangle: direction of stretch_u in the rest shape
                                           // (projected into the triangle); empty = any
  float max_stretch = 1.4f;                // stress plateau, as ElasticGrid's
};

// The elastic membrane of elastic_grid.h on a triangle mesh: orthotropic St. Venant–Kirchhoff with
// the rest shape as metric. x_u and x_v, the images of the material's unit vectors u and v ⟂ u, are
// linear in a triangle's corners, and with E = ½(G − G0), G their dot products,
//
//   ε = Σ_triangles A · ½ [K_u E_uu² + K_v E_vv² + S (2 E_uv)²],   isotropic where K_u = K_v = 2 S.
//
// Small strains cost the same as on ElasticGrid. The force is exactly −∂ε/∂r. As on the grid, each
// of the three stresses stays constant where its strain is beyond what max_stretch gives. Bending
// is added on top.
class TriangleMembrane {
 public:
  using Corners = std::array<std::uint32_t, 3>;

  TriangleMembrane() = default;
  // `triangles` are storage indices into `rest`; points without triangles are allowed. Triangles
  // without area get no stiffness.
  TriangleMembrane(std::span<const Corners> triangles, const VectorArray& rest,
                   const TriangleMaterial& material);

  std::size_t storage() const { return bound_.size(); }
  double energy(const VectorArray& position) const;  // joule
  // Adds the force Jacobian ∂f/∂r (negative semi-definite part only when `definite`): row and
  // column 3k+c for storage index k.
  void addForceJacobian(const VectorArray& position, bool definite,
                        std::vector<Eigen::Triplet<double>>& entries) const;
  // A bound of −∂f/∂r ≼ diag(K) for postures whose x_u and x_v are no longer than max_stretch, N/m:
  // what explicit steps must resolve. Largest over the directions in which the point can move, the
  // triangles around it turned with each other as in the rest shape. At rest the true stiffness is
  // about a third of it, most of which is the stretch to the plateau.
  const FloatArray& stiffnessBound() const { return bound_; }
  double maxStretch(const VectorArray& position) const;    // edge length over rest length
  const FloatArray& pointAreas() const { return areas_; }  // rest area of each point, m²
  // Each edge once, and how long it is stretched so many times.
  std::vector<StretchLimit::Edge> edges(float stretch) const;

  struct Triangle {
    Corners corners;
    // x_u = u[0] e1 + u[1] e2 and x_v likewise, e1 and e2 from corner 0 to corners 1 and 2; 1/m.
    float u[2], v[2];
    float stretch_u, stretch_v, shear;  // rest area × stiffness, Nm
    float inverseRest[3];  // 1/m² per squared length of the edges 01, 02 and 12 in the rest shape
  };
  const std::vector<Triangle>& triangles() const { return triangles_; }  // those with stiffness
  const std::vector<FoldEdge>& hinges() const { return hinges_; }        // if it bends
  float cap() const { return cap_; }  // plateau of |x_u|² − 1: max_stretch² − 1

 private:
  std::vector<Triangle> triangles_;
  std::vector<FoldEdge> hinges_;
  FloatArray bound_, areas_;
  float cap_ = 1;
};

}  // namespace fascia
