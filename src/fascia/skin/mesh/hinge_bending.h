#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include <fascia/base/aligned.h>
#include <fascia/math/types.h>

namespace fascia {

// Bending across an edge between two triangles: discrete shells (Grinspun et al. 2003),
//
//   ε = ½ k δ²,  k = κ |e|²/(A1 + A2),  δ: the dihedral angle θ less the rest shape's.
//
// With this k a bent sheet of regular triangles has the energy ½κ (1/R)² per area (Seung & Nelson
// 1988). The force is −∂ε/∂r until the edge or one of the triangles' heights over it is shorter
// than kSqueezed of its rest length; from there on it fades, because ∂θ/∂r grows with one over the
// height.
struct FoldEdge {
  // The edge's ends p0 and p1, and the corners opposite of it: triangles p0 p1 p2 and p1 p0 p3.
  std::array<std::uint32_t, 4> corners;
  float stiffness;             // k, Nm
  float restCosine, restSine;  // of θ
  float floor1, floor2;        // kSqueezed² of the squared rest heights over the edge, m²
  float floorEdge;             // kSqueezed² of the edge's squared rest length, m²

  static constexpr double kSqueezed = 0.7;
};

// Hinges with stiffness: one per edge that two of the triangles share. `bending` is per point, Nm;
// empty or all 0 gives none.
std::vector<FoldEdge> makeHinges(std::span<const std::array<std::uint32_t, 3>> triangles,
                                 const VectorArray& rest, const FloatArray& bending);

double hingeEnergy(const FoldEdge& hinge, const VectorArray& position);  // joule
// Adds −k ∂θ/∂r ∂θ/∂rᵀ, the negative semi-definite part of ∂f/∂r.
void addHingeJacobian(const FoldEdge& hinge, const VectorArray& position,
                      std::vector<Eigen::Triplet<double>>& entries);
// Blocks K, one per corner, with k ∂θ/∂r ∂θ/∂rᵀ ≼ diag(K) for the rest shape's angles between edges
// and heights down to kSqueezed of the rest shape's, N/m.
std::array<Mat3, 4> hingeStiffness(const FoldEdge& hinge, const VectorArray& rest);

}  // namespace fascia
