#include <algorithm>
#include <limits>

#include <fascia/deformable/body/body.h>

#include <fascia/base/assert.h>
#include <fascia/deformable/body/energy_kernels.h>

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

// What sums over the energy points of bodies of many functions need; one for each thread.
struct Room {
  DoubleArray F, rate, stresses, stiffnesses, blocks;
};
Room& room() {
  static thread_local Room mine;
  return mine;
}

}  // namespace

// Sums by the kernels, or point by point where there are few functions.
template <int D>
struct BodyShape::Sums {
  const BodyShape& body;

  // visit(point, F) of all energy points.
  template <class Visit>
  void forEachPoint(std::span<const double> q, Visit&& visit) const {
    DoubleArray& F = room().F;
    if (body.hasManyFunctions()) sumAll(q, F);
    for (std::size_t i = 0; i < body.volumes_.size(); ++i) visit(i, deformed(gradient(q, F, i)));
  }
  // visit(point, F, Ḟ), likewise.
  template <class Visit>
  void forEachPoint(std::span<const double> q, std::span<const double> v, Visit&& visit) const {
    DoubleArray &F = room().F, &rate = room().rate;
    if (body.hasManyFunctions()) sumAll(q, F), sumAll(v, rate);
    for (std::size_t i = 0; i < body.volumes_.size(); ++i)
      visit(i, deformed(gradient(q, F, i)), gradient(v, rate, i));
  }

  // force −= factor volume P ∂s/∂X of one point; finish() has to follow the last one.
  void addStress(std::size_t point, const Mat3& P, double factor, std::span<double> force) const {
    if (!body.hasManyFunctions()) {
      addStressForce<D>(P, body.slopes(point), body.shapeCount_, -factor * body.volumes_[point],
                        force.data());
      return;
    }
    DoubleArray& all = room().stresses;
    if (point == 0) all.assign(body.table_->tensorSize(), 0);
    for (int axis = 0; axis < D; ++axis)
      for (int row = 0; row < D; ++row)
        all[place(axis * D + row, point)] = -factor * body.volumes_[point] * P(row, axis);
  }
  void finish(std::span<double> force) const {
    if (body.hasManyFunctions())
      addStressForces(*body.table_, room().stresses.data(), force.data());
  }

  // The same of H += factor volume Bᵀ K B.
  void addStiffness(std::size_t point, const Mat9& K, double factor,
                    Eigen::Ref<Eigen::MatrixXd> H) const {
    if (!body.hasManyFunctions()) {
      addCongruence<D>(K, body.slopes(point), body.shapeCount_, factor * body.volumes_[point], H);
      return;
    }
    constexpr std::size_t kStride = SlopeTable::tensorStride(D);
    DoubleArray& all = room().stiffnesses;
    if (point == 0) all.assign(body.volumes_.size() * D * kStride, 0);
    double* to = all.data() + point * D * kStride;
    const double weight = factor * body.volumes_[point];
    for (int beta = 0; beta < D; ++beta, to += kStride)
      for (int alpha = 0, n = 0; alpha < D; ++alpha)
        for (int r = 0; r < D; ++r)
          for (int s = 0; s < D; ++s) to[n++] = weight * K(3 * alpha + r, 3 * beta + s);
  }
  void finish(Eigen::Ref<Eigen::MatrixXd> H) const {
    if (!body.hasManyFunctions()) return;
    addCongruences(*body.table_, room().stiffnesses.data(), H.data(),
                   static_cast<std::size_t>(H.outerStride()), room().blocks);
  }

 private:
  void sumAll(std::span<const double> q, DoubleArray& tensors) const {
    tensors.resize(body.table_->tensorSize());
    sumGradients(*body.table_, q.data(), tensors.data());
  }
  std::size_t place(std::size_t number, std::size_t point) const {
    return number * body.table_->pointStride + point;
  }
  Mat3 gradient(std::span<const double> q, const DoubleArray& tensors, std::size_t point) const {
    if (!body.hasManyFunctions())
      return gradientAt<D>(q.data(), body.slopes(point), body.shapeCount_);
    Mat3 F = Mat3::Zero();
    for (int axis = 0; axis < D; ++axis)
      for (int row = 0; row < D; ++row) F(row, axis) = tensors[place(axis * D + row, point)];
    return F;
  }
  static Mat3 deformed(Mat3 F) {
    if (D == 2) F(2, 2) = 1;
    return F;
  }
};

double BodyShape::leastGrowth(std::span<const double> q) const {
  return withDimension(dimension_, [&](auto d) {
    double least = volumes_.empty() ? 1 : std::numeric_limits<double>::infinity();
    Sums<d()>{*this}.forEachPoint(
        q, [&](std::size_t, const Mat3& F) { least = std::min(least, F.determinant()); });
    return least;
  });
}

double BodyShape::meanGrowth(std::span<const double> q) const {
  return withDimension(dimension_, [&](auto d) {
    double sum = 0, whole = 0;
    Sums<d()>{*this}.forEachPoint(q, [&](std::size_t i, const Mat3& F) {
      sum += volumes_[i] * F.determinant();
      whole += volumes_[i];
    });
    return whole > 0 ? sum / whole : 1;
  });
}

double BodyShape::energy(std::span<const double> q) const {
  FASCIA_ASSERT(q.size() == static_cast<std::size_t>(coordinateCount()),
                "the coordinates are of this body");
  return withDimension(dimension_, [&](auto d) {
    double sum = 0;
    Sums<d()>{*this}.forEachPoint(q, [&](std::size_t i, const Mat3& F) {
      sum += volumes_[i] * strainEnergyDensity(material_, F, crushing_);
    });
    return sum;
  });
}

void BodyShape::addElasticForce(std::span<const double> q, std::span<double> force) const {
  FASCIA_ASSERT(q.size() == static_cast<std::size_t>(coordinateCount()) && force.size() == q.size(),
                "the coordinates are of this body");
  withDimension(dimension_, [&](auto d) {
    const Sums<d()> sums{*this};
    sums.forEachPoint(q, [&](std::size_t i, const Mat3& F) {
      sums.addStress(i, strainStress(material_, F, crushing_), 1, force);
    });
    sums.finish(force);
  });
}

void BodyShape::addStiffness(std::span<const double> q, double factor, Curvature curvature,
                             Eigen::Ref<Eigen::MatrixXd> H) const {
  FASCIA_ASSERT(H.rows() == coordinateCount() && H.cols() == H.rows() &&
                    q.size() == static_cast<std::size_t>(H.rows()),
                "the matrix is of this body");
  withDimension(dimension_, [&](auto d) {
    const Sums<d()> sums{*this};
    sums.forEachPoint(q, [&](std::size_t i, const Mat3& F) {
      sums.addStiffness(i, strainStiffness(material_, F, curvature, crushing_), factor, H);
    });
    sums.finish(H);
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
    const Sums<d()> sums{*this};
    if (material_.relaxation_s > 0) {
      sums.forEachPoint(q, velocity, [&](std::size_t i, const Mat3& F, const Mat3& rate) {
        sums.addStress(i, relaxationStress(material_, F, rate), 1, force);
      });
      sums.finish(force);
    }
    if (material_.power_damping_s_per_J <= 0) return;
    // Power by power: V̇ = ∂V/∂q · q̇, then −k_d V̇ ∂V/∂q, in two passes to need no memory.
    double power = 0;
    sums.forEachPoint(q, velocity, [&](std::size_t i, const Mat3& F, const Mat3& rate) {
      power += volumes_[i] * strainStress(material_, F, crushing_).cwiseProduct(rate).sum();
    });
    sums.forEachPoint(q, [&](std::size_t i, const Mat3& F) {
      sums.addStress(i, strainStress(material_, F, crushing_),
                     material_.power_damping_s_per_J * power, force);
    });
    sums.finish(force);
  });
}

void BodyShape::addDampingMatrix(std::span<const double> q, double factor,
                                 Eigen::Ref<Eigen::MatrixXd> D, std::span<double> scratch) const {
  FASCIA_ASSERT(D.rows() == coordinateCount() && D.cols() == D.rows() &&
                    scratch.size() >= static_cast<std::size_t>(D.rows()),
                "the matrix is of this body");
  D.diagonal().array() += factor * material_.drag_per_s;
  withDimension(dimension_, [&](auto d) {
    if (material_.relaxation_s <= 0) return;
    const Sums<d()> sums{*this};
    sums.forEachPoint(q, [&](std::size_t i, const Mat3& F) {
      sums.addStiffness(i, relaxationViscosity(material_, F), factor, D);
    });
    sums.finish(D);
  });
  if (material_.power_damping_s_per_J <= 0) return;
  Eigen::Map<Eigen::VectorXd> gradient(scratch.data(), coordinateCount());
  gradient.setZero();
  addElasticForce(q, scratch);
  D += (factor * material_.power_damping_s_per_J) * gradient * gradient.transpose();
}

}  // namespace fascia
