#include <fascia/deformable/body/carried_mesh.h>

#include <fascia/deformable/matter/strain_energy.h>

namespace fascia {
namespace {

// From here on Eigen takes products of R for those of large matrices, which take long to begin.
constexpr Eigen::Index kFunctionsOfLargeBodies = 12;

// x = R p, F = R ∂p/∂X in three dimensions.
void carryPoint(const Eigen::MatrixXd& R, const double* p, const double* slopes, Vec3& x, Mat3& F) {
  const Eigen::Index count = R.cols();
  x.setZero(), F.setZero();
  for (Eigen::Index j = 0; j < count; ++j) {
    const Vec3 column = R.col(j);
    x += p[j] * column;
    for (int axis = 0; axis < 3; ++axis) F.col(axis) += slopes[axis * count + j] * column;
  }
}

}  // namespace

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
    Mat3 F = Mat3::Identity();
    if (d == 3 && R.cols() >= kFunctionsOfLargeBodies) {
      carryPoint(R, values_.col(column).data(), gradients_.col(3 * column).data(), x, F);
    } else {
      x.head(d).noalias() = R * values_.col(column);
      F.topLeftCorner(d, d).noalias() = R * gradients_.middleCols(3 * column, d);
    }
    const Vec3 normal = cofactors(F) * undeformed_.normals[i].cast<double>();
    const double length = normal.norm();
    out.positions[i] = x.cast<float>();
    out.normals[i] =
        length > 0 ? Eigen::Vector3f((normal / length).cast<float>()) : undeformed_.normals[i];
  }
}

}  // namespace fascia
