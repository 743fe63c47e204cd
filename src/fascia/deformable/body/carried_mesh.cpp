#include <fascia/deformable/body/carried_mesh.h>

#include <fascia/deformable/matter/strain_energy.h>

namespace fascia {

CarriedMesh::CarriedMesh(const BodyShape& shape, TriangleMesh undeformed)
    : shape_(&shape), undeformed_(std::move(undeformed)) {
  if (undeformed_.normals.size() != undeformed_.positions.size())
    computeNormals(undeformed_.positions, undeformed_.triangles, undeformed_.normals);
  const auto count = static_cast<Eigen::Index>(undeformed_.positions.size());
  values_.resize(shape.shapeCount(), count);
  gradients_.resize(shape.shapeCount(), 3 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vec3 X = undeformed_.positions[static_cast<std::size_t>(i)].cast<double>();
    shape.basis().values(X, values_.col(i));
    Eigen::MatrixXd slopes(shape.shapeCount(), 3);
    shape.basis().gradients(X, slopes);
    gradients_.middleCols(3 * i, 3) = slopes;
  }
}

void CarriedMesh::carry(std::span<const double> q, TriangleMesh& out) const {
  const int d = shape_->dimension();
  const Eigen::MatrixXd R = shape_->shapeMatrix(q);
  const std::size_t count = undeformed_.positions.size();
  if (out.positions.size() != count) out = undeformed_;
  for (std::size_t i = 0; i < count; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    Vec3 x = undeformed_.positions[i].cast<double>();
    x.head(d).noalias() = R * values_.col(column);
    Mat3 F = Mat3::Identity();
    F.topLeftCorner(d, d).noalias() = R * gradients_.middleCols(3 * column, d);
    const Vec3 normal = cofactors(F) * undeformed_.normals[i].cast<double>();
    const double length = normal.norm();
    out.positions[i] = x.cast<float>();
    out.normals[i] =
        length > 0 ? Eigen::Vector3f((normal / length).cast<float>()) : undeformed_.normals[i];
  }
}

}  // namespace fascia
