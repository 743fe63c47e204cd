#pragma once

#include <span>

#include <fascia/deformable/body/body.h>
#include <fascia/geometry/triangle_mesh.h>

namespace fascia {

// A mesh whose vertices are material points of a body: carried through its deformation, x = R p(X),
// with normals by the cofactors of ∂x/∂X, so that edges stay as hard or smooth as they were made.
// In two dimensions z stays.
class CarriedMesh {
 public:
  // Vertices are undeformed points of the body; normals are computed if there are none.
  CarriedMesh(const BodyShape& shape, TriangleMesh undeformed);

  const TriangleMesh& undeformed() const { return undeformed_; }
  // The mesh at q, into `out`, which keeps uvs and triangles. Allocates only the first time.
  void carry(std::span<const double> q, TriangleMesh& out) const;

 private:
  const BodyShape* shape_;
  TriangleMesh undeformed_;
  Eigen::MatrixXd values_;     // k × vertices: p(X)
  Eigen::MatrixXd gradients_;  // k × 3 vertices: ∂p/∂X
};

}  // namespace fascia
