#pragma once

#include <array>
#include <memory>
#include <span>

#include <fascia/deformable/body/body_model.h>
#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// The map x = R p(X) of one body at one moment, and its inverse. Far outside of the body's matter
// polynomials say nothing of use: beyond its box and a margin the map goes on straight, as its
// tangent at the nearest point of that box. In two dimensions z stays as it is.
class BodyMap {
 public:
  // `domain` is a box around the undeformed matter, `surface` has points on its surface and their
  // normals. Throws Error if the basis is larger than kMaxShapes.
  BodyMap(BodyShapePtr shape, const Box& domain_m, const TriangleMesh& surface = {});
  static constexpr int kMaxShapes = 512;

  // The body's own coordinates and their rates. Allocates nothing.
  void set(std::span<const double> q, std::span<const double> v);

  struct Tangent {
    Vec3 x_m;
    Mat3 gradient;  // ∂x/∂X
  };
  Tangent at(const Vec3& X) const;
  Vec3 point(const Vec3& X) const { return at(X).x_m; }
  Vec3 velocity(const Vec3& X) const;

  // The point that is at x now; `gradient` there. Not found: no point could be followed to there,
  // X is the nearest that was.
  struct Inverse {
    Vec3 X_m;
    Mat3 gradient;
    bool found;
  };
  Inverse inverse(const Vec3& x) const;

  bool affine() const { return constant_->affine; }
  const Tangent& center() const { return center_; }  // at the domain's center
  const Vec3& centerVelocity_m_per_s() const { return centerVelocity_m_per_s_; }
  const Mat3& centerRate_per_s() const { return centerRate_per_s_; }  // of the gradient
  const Vec3& center_m() const { return constant_->center_m; }        // undeformed

  // How far the deformed domain's middle lines bulge out of the straight: along each axis the
  // farthest, m.
  std::array<Vec3, 3> bulges() const;
  // A box around the deformed domain.
  const Box& bounds() const { return bounds_; }
  // What can be said of the distance to the surface without an inverse; the direction away from it.
  struct Clearance {
    double distance_m;
    Vec3 away;
  };
  // From the plane that touches the deformed surface in the nearest of the given points; off by
  // about their spacing squared over the radius of curvature.
  Clearance planeClearance(const Vec3& x) const;
  // From bounds(), for points outside of it: no point of the matter is nearer.
  Clearance boxClearance(const Vec3& x) const;

 private:
  // What no state changes; shared by all copies.
  struct Constant {
    BodyShapePtr shape;
    int dimension, shapeCount;
    bool affine;
    Box domain_m, reach_m;
    Vec3 center_m;
    int sampleCount;  // along each axis
    // A lattice over the domain, x fastest; from latticeCount on, the points of the surface.
    std::vector<Vec3> samples_m;
    std::size_t latticeCount;
    std::vector<Vec3> normals;     // of the surface's points
    Eigen::MatrixXd sampleValues;  // p at each, shapeCount × samples
  };
  Tangent tangentOf(const Eigen::MatrixXd& R, const Vec3& X, bool isRate) const;
  void measure();
  double largestBend_m(std::size_t axis) const;
  Mat3 slope(const Vec3& X, const Mat3& gradient) const;
  std::size_t nearestSample(const Vec3& x, std::size_t first) const;
  Inverse newton(const Vec3& x, const Vec3& start) const;

  std::shared_ptr<const Constant> constant_;
  Eigen::MatrixXd R_, rate_;  // dimension × k, and its rate of change
  Tangent center_;
  Vec3 centerVelocity_m_per_s_ = Vec3::Zero();
  Mat3 centerRate_per_s_ = Mat3::Zero();
  std::vector<Vec3> deformed_m_;  // the samples
  Box bounds_;
};

// Maps a mesh of undeformed points, and turns its normals.
void deform(const BodyMap& map, TriangleMesh& mesh);

}  // namespace fascia
