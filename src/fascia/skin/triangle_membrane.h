#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include <fascia/base/aligned.h>
#include <fascia/math/types.h>

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

// The elastic membrane of spec L4 on a triangle mesh: orthotropic St. Venant–Kirchhoff, E = ½(G −
// G0) per triangle with the rest shape as metric, written in the three squared edge lengths, in
// which E is linear:
//
//   ε = Σ_triangles ½ dᵀ C d,   d_k = |e_k|² − G_k,   force along edge k: ∝ (C d)_k e_k
//
// and hinge bending across edges with two triangles. The force is exactly −∂ε/∂r of this energy up
// to max_stretch, beyond which the stress stays constant (see ElasticGrid).
class TriangleMembrane {
 public:
  TriangleMembrane() = default;
  // `triangles` are storage indices into `rest`; points without triangles are allowed.
  TriangleMembrane(std::span<const std::array<std::uint32_t, 3>> triangles, const VectorArray& rest,
                   const TriangleMaterial& material);

  std::size_t storage() const { return bound_.size(); }
  double energy(const VectorArray& position) const;  // joule
  void addForceJacobian(const VectorArray& position, bool definite,
                        std::vector<Eigen::Triplet<double>>& entries) const;
  // Bound of the row sums of |−∂f/∂r| for every posture within max_stretch, N/m; bending included.
  const FloatArray& stiffnessBound() const { return bound_; }
  double maxStretch(const VectorArray& position) const;  // edge length over rest length
  const FloatArray& pointAreas() const { return areas_; }  // rest area of each point, m²

 private:
  FloatArray bound_, areas_;
};

}  // namespace fascia
