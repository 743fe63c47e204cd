#pragma once

#include <functional>
#include <memory>
#include <string_view>

#include <fascia/material/body_def.h>
#include <fascia/math/types.h>

namespace fascia {

// The functions p(X) of the undeformed point X whose combinations are a body's shapes: x = R p(X)
// (Witkin & Welch 1990, §2.2, x_i = R_ij p_j). They depend on neither R nor time, so everything
// built from them is constant. A new kind of deformation is one class; nothing else knows kinds.
// The span of p must contain 1 and the coordinates of X, or no body could rest or be moved.
class Basis {
 public:
  // Degrees of polynomials along each axis, and of all their terms together at most.
  struct Degrees {
    Eigen::Vector3i axes;
    int total;
  };

  virtual ~Basis() = default;

  virtual std::string_view name() const = 0;
  virtual int dimension() const = 0;  // 2 (bodies in the plane z = 0) or 3
  virtual int size() const = 0;       // k, the number of functions
  // Degree of p as polynomials in X: what tells the quadratures how fine to be. Of functions that
  // are no polynomials: the degree of those that approximate them well enough.
  virtual int degree() const = 0;
  // The same of ∂p/∂X, which energies are made of; 0 of what are no polynomials but piece by piece.
  virtual Degrees slopeDegrees() const {
    const int slope = degree() - 1;
    return {Eigen::Vector3i::Constant(slope), slope};
  }

  // p(X); `p` has size() entries, X is in metres, in the undeformed body.
  virtual void values(const Vec3& X, Eigen::Ref<Eigen::VectorXd> p) const = 0;
  // ∂p/∂X, size() x 3, 1/m; the third column is 0 in two dimensions.
  virtual void gradients(const Vec3& X, Eigen::Ref<Eigen::MatrixXd> dp) const = 0;
};

using BasisPtr = std::shared_ptr<const Basis>;

// p = [X, Y, (Z,) 1] (§2.3): a body that stretches and shears. Throws Error unless dimension is 2
// or 3, like all of these.
BasisPtr makeAffineBasis(int dimension);

// All monomials up to the total degree `order` in [1, kMaxPolynomialOrder]: order 2 is the paper's
// second-order body (§2.2, figure 1). They are taken of X mapped from `domain` to [-1, 1], which
// spans the same shapes and keeps high orders well conditioned.
BasisPtr makePolynomialBasis(int dimension, int order, const Box& domain);

// A free-form deformation lattice (Sederberg & Parry 1986): products of Bernstein polynomials of
// degree cells[axis] in [1, kMaxLatticeCells] over `domain`; R's columns are then the lattice's
// control points, with the x index running fastest.
BasisPtr makeBernsteinBasis(int dimension, const Eigen::Vector3i& cells, const Box& domain);

// Functions from data: p = w_j(X) [X, Y, (Z,) 1] with the smoothest weights w_j there are, the
// lowest eigenmodes of the body's own Laplacian ("skinning eigenmodes", Benchekroun, Zhang,
// Chaudhuri, Grinspun, Zhou & Jacobson 2023, §4). The body is where `inside` holds; it is cut into
// cubic cells of edge cell_m, trilinear in each. `modes` >= 1; w_0 is constant.
BasisPtr makeSkinningModesBasis(int dimension, int modes, const Box& domain, double cell_m,
                                const std::function<bool(const Vec3&)>& inside);

// The basis that files mean, over a box around the undeformed body. Throws Error for numbers out of
// their ranges.
BasisPtr makeBasis(const BodyBasisDef& def, int dimension, const Box& box_m);

}  // namespace fascia
