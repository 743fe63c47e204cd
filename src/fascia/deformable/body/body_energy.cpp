#include <algorithm>
#include <limits>

#include <fascia/deformable/body/body.h>

#include <fascia/base/assert.h>

// The sums over energy points. A body in the plane is one of unit thickness that does not stretch
// across: F has F_zz = 1, and the densities' values are those of two dimensions.

namespace fascia {
namespace {

// F = ∂x/∂X = Σ_j q_j ⊗ ∂s_j/∂X, or the same of velocities, without the plane's F_zz.
template <int D>
Mat3 gradientAt(const double* q, const double* slopes, int shapeCount) {
  Mat3 F = Mat3::Zero();
  for (int j = 0; j < shapeCount; ++j)
    for (int axis = 0; axis < D; ++axis)
      for (int row = 0; row < D; ++row) F(row, axis) += q[j * D + row] * slopes[j * D + axis];
  return F;
}

// f_j += factor P ∂s_j/∂X.
template <int D>
void addStressForce(const Mat3& P, const double* slopes, int shapeCount, double factor, double* f) {
  for (int j = 0; j < shapeCount; ++j) {
    for (int row = 0; row < D; ++row) {
      double sum = 0;
      for (int axis = 0; axis < D; ++axis) sum += P(row, axis) * slopes[j * D + axis];
      f[j * D + row] += factor * sum;
    }
  }
}

// H += factor Bᵀ K B with the constant B = ∂F/∂q.
template <int D>
void addCongruence(const Mat9& K, const double* slopes, int shapeCount, double factor,
                   Eigen::Ref<Eigen::MatrixXd> H) {
  using Block = Eigen::Matrix<double, D, D>;
  for (int j = 0; j < shapeCount; ++j) {
    Eigen::Matrix<double, 9, D> column = Eigen::Matrix<double, 9, D>::Zero();
    for (int axis = 0; axis < D; ++axis)
      column += (factor * slopes[j * D + axis]) * K.template block<9, D>(0, 3 * axis);
    for (int i = 0; i < shapeCount; ++i) {
      Block block = Block::Zero();
      for (int axis = 0; axis < D; ++axis)
        block += slopes[i * D + axis] * column.template block<D, D>(3 * axis, 0);
      H.block<D, D>(i * D, j * D) += block;
    }
  }
}

template <class Visit>
auto withDimension(int dimension, Visit&& visit) {
  return dimension == 2 ? visit(std::integral_constant<int, 2>{})
                        : visit(std::integral_constant<int, 3>{});
}

template <int D>
Mat3 deformationAt(const double* q, const double* slopes, int shapeCount) {
  Mat3 F = gradientAt<D>(q, slopes, shapeCount);
  if (D == 2) F(2, 2) = 1;
  return F;
}

}  // namespace

double BodyShape::leastGrowth(std::span<const double> q) const {
  return withDimension(dimension_, [&](auto d) {
    double least = volumes_.empty() ? 1 : std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < volumes_.size(); ++i)
      least = std::min(least, deformationAt<d()>(q.data(), slopes(i), shapeCount_).determinant());
    return least;
  });
}

double BodyShape::meanGrowth(std::span<const double> q) const {
  return withDimension(dimension_, [&](auto d) {
    double sum = 0, whole = 0;
    for (std::size_t i = 0; i < volumes_.size(); ++i) {
      sum += volumes_[i] * deformationAt<d()>(q.data(), slopes(i), shapeCount_).determinant();
      whole += volumes_[i];
    }
    return whole > 0 ? sum / whole : 1;
  });
}

double BodyShape::energy(std::span<const double> q) const {
  FASCIA_ASSERT(q.size() == static_cast<std::size_t>(coordinateCount()),
                "the coordinates are of this body");
  return withDimension(dimension_, [&](auto d) {
    double sum = 0;
    for (std::size_t i = 0; i < volumes_.size(); ++i)
      sum += volumes_[i] * strainEnergyDensity(material_,
                                               deformationAt<d()>(q.data(), slopes(i), shapeCount_),
                                               crushing_);
    return sum;
  });
}

void BodyShape::addElasticForce(std::span<const double> q, std::span<double> force) const {
  FASCIA_ASSERT(q.size() == static_cast<std::size_t>(coordinateCount()) && force.size() == q.size(),
                "the coordinates are of this body");
  withDimension(dimension_, [&](auto d) {
    for (std::size_t i = 0; i < volumes_.size(); ++i) {
      const Mat3 F = deformationAt<d()>(q.data(), slopes(i), shapeCount_);
      addStressForce<d()>(strainStress(material_, F, crushing_), slopes(i), shapeCount_,
                          -volumes_[i], force.data());
    }
  });
}

void BodyShape::addStiffness(std::span<const double> q, double factor, Curvature curvature,
                             Eigen::Ref<Eigen::MatrixXd> H) const {
  FASCIA_ASSERT(H.rows() == coordinateCount() && H.cols() == H.rows() &&
                    q.size() == static_cast<std::size_t>(H.rows()),
                "the matrix is of this body");
  withDimension(dimension_, [&](auto d) {
    for (std::size_t i = 0; i < volumes_.size(); ++i) {
      const Mat3 F = deformationAt<d()>(q.data(), slopes(i), shapeCount_);
      addCongruence<d()>(strainStiffness(material_, F, curvature, crushing_), slopes(i),
                         shapeCount_, factor * volumes_[i], H);
    }
  });
}

bool BodyShape::damped() const {
  return material_.drag_per_s > 0 || material_.power_damping_s_per_J > 0 ||
         (material_.relaxation_s > 0 && material_.rigidity_Pa > 0);
}

void BodyShape::addDampingForce(std::span<const double> q, std::span<const double> velocity,
                                std::span<double> force) const {
  FASCIA_ASSERT(velocity.size() == q.size() && force.size() == q.size(),
                "the coordinates are of this body");
  const auto n = static_cast<Eigen::Index>(q.size());
  Eigen::Map<Eigen::VectorXd> f(force.data(), n);
  const Eigen::Map<const Eigen::VectorXd> v(velocity.data(), n);
  f -= material_.drag_per_s * v;
  withDimension(dimension_, [&](auto d) {
    if (material_.relaxation_s > 0) {
      for (std::size_t i = 0; i < volumes_.size(); ++i) {
        const Mat3 F = deformationAt<d()>(q.data(), slopes(i), shapeCount_);
        const Mat3 rate = gradientAt<d()>(velocity.data(), slopes(i), shapeCount_);
        addStressForce<d()>(relaxationStress(material_, F, rate), slopes(i), shapeCount_,
                            -volumes_[i], force.data());
      }
    }
    if (material_.power_damping_s_per_J <= 0) return;
    // Power by power: V̇ = ∂V/∂q · q̇, then −k_d V̇ ∂V/∂q, in two passes to need no memory.
    double power = 0;
    for (std::size_t i = 0; i < volumes_.size(); ++i) {
      const Mat3 F = deformationAt<d()>(q.data(), slopes(i), shapeCount_);
      const Mat3 rate = gradientAt<d()>(velocity.data(), slopes(i), shapeCount_);
      power += volumes_[i] * strainStress(material_, F, crushing_).cwiseProduct(rate).sum();
    }
    for (std::size_t i = 0; i < volumes_.size(); ++i) {
      const Mat3 F = deformationAt<d()>(q.data(), slopes(i), shapeCount_);
      addStressForce<d()>(strainStress(material_, F, crushing_), slopes(i), shapeCount_,
                          -material_.power_damping_s_per_J * power * volumes_[i], force.data());
    }
  });
}

void BodyShape::addDampingMatrix(std::span<const double> q, double factor,
                                 Eigen::Ref<Eigen::MatrixXd> D, std::span<double> scratch) const {
  FASCIA_ASSERT(D.rows() == coordinateCount() && D.cols() == D.rows() &&
                    scratch.size() >= static_cast<std::size_t>(D.rows()),
                "the matrix is of this body");
  D.diagonal().array() += factor * material_.drag_per_s;
  withDimension(dimension_, [&](auto d) {
    if (material_.relaxation_s > 0) {
      for (std::size_t i = 0; i < volumes_.size(); ++i) {
        const Mat3 F = deformationAt<d()>(q.data(), slopes(i), shapeCount_);
        addCongruence<d()>(relaxationViscosity(material_, F), slopes(i), shapeCount_,
                           factor * volumes_[i], D);
      }
    }
  });
  if (material_.power_damping_s_per_J <= 0) return;
  Eigen::Map<Eigen::VectorXd> gradient(scratch.data(), coordinateCount());
  gradient.setZero();
  addElasticForce(q, scratch);
  D += (factor * material_.power_damping_s_per_J) * gradient * gradient.transpose();
}

}  // namespace fascia
