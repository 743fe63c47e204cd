#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include <fascia/base/aligned.h>
#include <fascia/skin/grid/grid_layout.h>

namespace fascia {

// The optional bending term of Terzopoulos et al. 1987: per interior point
//
//   ε = Σ ξ_ab (B_ab − B0_ab)²,   B_ab = n · ∂²r/∂a∂b,   ab = 11, 22, 12 (12 twice),
//
// with central differences in material coordinates scaled to metres and n the unit normal of the
// central tangents. The force is the exact gradient, the change of n included, until the gradient
// is much larger than at rest; from there on it fades, so that its stiffness is bounded however the
// grid is folded and crushed. ξ = A κ/2 with the bending stiffness κ in N m and the point's rest
// area A, so κ means the same at every resolution.
class Bending {
 public:
  Bending() = default;
  // stiffness_Nm: per point in storage order; an all-zero array makes the term vanish.
  Bending(const GridLayout& layout, const VectorArray& rest, const FloatArray& stiffness_Nm);

  bool active() const { return !nodes_.empty(); }
  double energy(const VectorArray& position) const;
  void addForces(const VectorArray& position, VectorArray& force) const;
  // Gauss–Newton part of the Jacobian (negative semi-definite): −2 Σ ξ ∇B ∇Bᵀ, faded likewise.
  void addForceJacobian(const VectorArray& position,
                        std::vector<Eigen::Triplet<double>>& entries) const;
  // Adds Σ 2ξ s sᵀ, s the second differences, point p = j·columns + i: the stiffness along normals,
  // N/m, of a flat rest shape; of any shape, no less than that of the Gauss–Newton part at rest.
  void addStiffness(std::vector<Eigen::Triplet<double>>& entries) const;
  // Adds a bound of that part's row sums per point, of any shape, N/m.
  void addStiffnessBound(FloatArray& bound) const;

 private:
  struct Node {
    std::size_t stencil[9];  // storage indices: rows below, same, above; columns left to right
    float weight;            // ξ
    float inverse[3];        // 1/h1², 1/h2², 1/(h1 h2)
    float rest[3];           // B0 of 11, 22, 12
    float usual[3][9];       // the norms of the gradients at rest, or a share of flat ones', 1/m²
  };
  struct Curvature;  // B and its gradient over the stencil
  // What is left of a force whose gradient is larger than it may be, 0 to 1.
  static double fade(const Node& node, const Curvature& at, int component);
  int pointOf(std::size_t storage) const;
  Curvature curvature(const Node& node, const VectorArray& r) const;

  GridLayout layout_;
  std::vector<Node> nodes_;
  std::vector<std::size_t> firstOfRow_;  // nodes_ of row j: [firstOfRow_[j], firstOfRow_[j+1])
};

}  // namespace fascia
