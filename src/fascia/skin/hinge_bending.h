#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include <fascia/base/aligned.h>

namespace fascia {

// Bending across an edge between two triangles: discrete shells (Grinspun et al. 2003),
//
//   ε = ½ k δ²,  k = κ |e|²/(A1 + A2),  δ: the dihedral angle θ less the rest shape's.
//
// With this k a bent sheet of regular triangles has the energy ½κ (1/R)² per area (Seung & Nelson
// 1988). The force is −∂ε/∂r until a triangle is squeezed to less than kSqueezed of its rest area
// or the edge of its length; from there on it fades, because ∂θ/∂r grows with one over the height.
struct Hinge {
  // The edge's ends p0 and p1, and the corners opposite of it: triangles p0 p1 p2 and p1 p0 p3.
  std::array<std::uint32_t, 4> corners;
  float stiffness;             // k, Nm
  float restCosine, restSine;  // of θ
  float floor1, floor2;        // kSqueezed² of the rest |n1|², |n2|² (m⁴), n twice the area
  float floorEdge;             // kSqueezed² of the rest |e|², m²

  static constexpr double kSqueezed = 0.7;
};

// Hinges with stiffness: one per edge that two of the triangles share. `bending` is per point, Nm;
// empty or all 0 gives none.
std::vector<Hinge> makeHinges(std::span<const std::array<std::uint32_t, 3>> triangles,
                              const VectorArray& rest, const FloatArray& bending);

double hingeEnergy(const Hinge& hinge, const VectorArray& position);  // joule
// Adds −k ∂θ/∂r ∂θ/∂rᵀ, the negative semi-definite part of ∂f/∂r.
void addHingeJacobian(const Hinge& hinge, const VectorArray& position,
                      std::vector<Eigen::Triplet<double>>& entries);
// K with k ∂θ/∂r ∂θ/∂rᵀ ≼ diag(K) in postures that are not squeezed, per corner, N/m.
std::array<double, 4> hingeStiffness(const Hinge& hinge, const VectorArray& rest);

}  // namespace fascia
