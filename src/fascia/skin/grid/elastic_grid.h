#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include <fascia/base/aligned.h>
#include <fascia/math/types.h>
#include <fascia/skin/grid/grid_layout.h>

namespace fascia {

// Material of a grid, one value per point in GridLayout storage order.
struct GridMaterial {
  FloatArray stretch_u, stretch_v, shear;  // N/m
  FloatArray prestretch;                   // length in the rest shape over relaxed length
  float max_stretch = 1.4f;                // stress plateau, see ElasticGrid
};

// The elastic membrane of Terzopoulos et al. 1987 on a regular grid, discretised so that
// the force is exactly −∂ε/∂r of a discrete energy:
//
//   ε = Σ_edges  w/4 · (|e|² − G)²            G11 on edges along u, G22 on edges along v
//     + Σ_cells  w12/2 · (s1·s2 − G12)²       s1, s2: mean of a cell's opposite edges
//
// The one-point shear per cell keeps the grid symmetric and cannot hourglass: the hourglass mode
// stretches edges. Weights hold rest area and stiffness: small-strain stiffness in N/m is the same
// at every resolution (w = A·K/(2 L⁴), w12 = A·S/(L1 L2)²).
// Deviation from the paper: where a length exceeds max_stretch times its rest length the stress
// stays constant instead of growing with the cube; this bounds the stiffness for any posture, and
// with it the step that is stable.
class ElasticGrid {
 public:
  ElasticGrid() = default;
  // rest: positions of the rest shape (pads filled). The relaxed lengths are those of the rest
  // shape divided by prestretch.
  ElasticGrid(const GridLayout& layout, const VectorArray& rest, const GridMaterial& material);

  const GridLayout& layout() const { return layout_; }
  double energy(const VectorArray& position) const;  // joule
  // Adds the force Jacobian ∂f/∂r (negative semi-definite part only when `definite`): row and
  // column 3p+c for point p = j·columns + i.
  void addForceJacobian(const VectorArray& position, bool definite,
                        std::vector<Eigen::Triplet<double>>& entries) const;
  // A bound of the row sums of |−∂f/∂r| for every point and every posture within max_stretch, N/m:
  // what explicit steps must resolve. Cells that fold onto a line while they are stretched to the
  // plateau can exceed it by two thirds; such a posture does not last.
  const FloatArray& stiffnessBound() const { return bound_; }
  // Largest edge length over its rest-shape length (prestretch does not count).
  double maxStretch(const VectorArray& position) const;

  // Coefficients in storage order, read by the SIMD kernels; zero across an open border.
  struct Coefficients {
    FloatArray w1, g1;           // edge (i,j)–(i+1,j): weight, relaxed squared length
    FloatArray w2, g2;           // edge (i,j)–(i,j+1)
    FloatArray w12, g12, lim12;  // cell with lowest corner (i,j); lim12: plateau of s1·s2 − G12
    float cap = 1;               // plateau of (|e|² − G)/G: max_stretch² − 1
  };
  const Coefficients& coefficients() const { return c_; }
  // Lengths in the rest shape of the edges (i, j)–(i + 1, j) and (i, j)–(i, j + 1); 0: none.
  float restLengthU_m(int i, int j) const { return restLength1_[layout_.at(i, j)]; }
  float restLengthV_m(int i, int j) const { return restLength2_[layout_.at(i, j)]; }

 private:
  void computeBound();

  GridLayout layout_;
  Coefficients c_;
  FloatArray bound_, restLength1_, restLength2_;  // lengths of the rest shape, metres
};

// Copies each row's ends into its pads, closing the tube.
void fillPads(const GridLayout& layout, FloatArray& values);
void fillPads(const GridLayout& layout, VectorArray& values);

// Rest area that belongs to each point, m².
FloatArray pointAreas(const GridLayout& layout, const VectorArray& rest);

}  // namespace fascia
