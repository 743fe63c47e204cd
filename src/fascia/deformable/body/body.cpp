#include <fascia/deformable/body/body.h>

#include <cmath>

#include <Eigen/Cholesky>

#include <fascia/base/assert.h>
#include <fascia/base/error.h>
#include <fascia/deformable/body/energy_kernels.h>

namespace fascia {
namespace {

// Shapes with less than this part of the inertia of a usual one cannot be told from none.
constexpr double kMassTolerance = 1e-13;
// The undeformed body is represented to rounding, or the basis lacks the linear functions.
constexpr double kRestTolerance = 1e-7;
// From here on sums over energy points are worth their kernels. The paper's bodies have ten.
constexpr int kManyFunctions = 12;

void check(const BodyMaterial& material) {
  Diagnostics diagnostics;
  validateTunables(material, "/material", diagnostics);
  diagnostics.throwIfErrors();
}

}  // namespace

BodyShape::BodyShape(const BodyDef& def)
    : basis_(def.basis), material_(def.material), crushing_(def.crushing) {
  check(def.material);
  if (!basis_) throw Error("body: found no basis, expected one");
  dimension_ = basis_->dimension(), shapeCount_ = basis_->size();
  factorMass(def);
  findRest(def);
  prepareEnergy(def);
}

void BodyShape::factorMass(const BodyDef& def) {
  const Eigen::Index k = shapeCount_;
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(k, k);
  FASCIA_ASSERT(k > 0 && (dimension_ == 2 || dimension_ == 3),
                "a basis spans two or three dimensions");
  FASCIA_ASSERT(def.matter.mass.points_m.size() == def.matter.mass.weights.size(),
                "every point of mass has a weight");
  Eigen::VectorXd p(k);
  Box box;
  for (std::size_t i = 0; i < def.matter.mass.size(); ++i) {
    const Vec3& X = def.matter.mass.points_m[i];
    const double m_kg = def.matter.mass.weights[i];
    basis_->values(X, p);
    M.selfadjointView<Eigen::Lower>().rankUpdate(p, m_kg);
    mass_kg_ += m_kg, center_m_ += m_kg * X;
    box.add(X);
  }
  if (!(mass_kg_ > 0)) throw Error("body: found no mass, expected some");
  center_m_ /= mass_kg_;
  size_m_ = box.size().maxCoeff();
  // Scaled to a unit diagonal, pivots are comparable: functions of X² are small, not dependent.
  const Eigen::VectorXd scale = M.diagonal().cwiseMax(0.0).cwiseSqrt();
  Eigen::MatrixXd unit = M.selfadjointView<Eigen::Lower>();
  unit = scale.cwiseInverse().asDiagonal() * unit * scale.cwiseInverse().asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> cholesky(unit);
  const bool sound = scale.minCoeff() > 0 && cholesky.info() == Eigen::Success;
  massRoot_ = cholesky.matrixL();
  if (!sound || massRoot_.diagonal().cwiseAbs2().minCoeff() < kMassTolerance) {
    Issue issue{{},
                "body: its mass leaves some shape of the " + std::string(basis_->name()) +
                    " basis without inertia",
                "spread the mass over more points, or take a basis of lower order"};
    throw Error(issue);
  }
  massRoot_ = scale.asDiagonal() * massRoot_;
}

void BodyShape::findRest(const BodyDef& def) {
  // s is orthonormal over the mass, so Σ m g(X) s(X)ᵀ projects any g(X) onto the shapes.
  rest_ = Eigen::MatrixXd::Zero(dimension_, shapeCount_);
  momentumWeights_ = Eigen::VectorXd::Zero(shapeCount_);
  const Quadrature& mass = def.matter.mass;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    const Eigen::VectorXd s = pointWeights(mass.points_m[i]);
    rest_ += mass.weights[i] * mass.points_m[i].head(dimension_) * s.transpose();
    momentumWeights_ += mass.weights[i] * s;
  }
  double error = 0;
  for (const Vec3& X : def.matter.volume.points_m) {
    const Eigen::VectorXd s = pointWeights(X);
    error = std::max(error, (rest_ * s - X.head(dimension_)).norm() / size_m_);
    error = std::max(error, std::abs(momentumWeights_.dot(s) - 1));
  }
  if (error < kRestTolerance) return;
  Issue issue{{},
              "body: the " + std::string(basis_->name()) +
                  " basis represents its undeformed shape to " + std::to_string(error) +
                  " of its size only",
              "the basis must contain 1 and the coordinates of X"};
  throw Error(issue);
}

void BodyShape::prepareEnergy(const BodyDef& def) {
  Eigen::MatrixXd dp(shapeCount_, 3);
  const Quadrature& volume = def.matter.volume;
  FASCIA_ASSERT(volume.size() > 0, "energy is measured somewhere");
  // Where ∂x/∂X is constant one point is as good as all.
  const std::size_t count = basis_->degree() == 1 ? 1 : volume.size();
  volume_m3_ = volume.total();
  for (std::size_t i = 0; i < count; ++i) {
    if (!(volume.weights[i] > 0)) throw Error("body: found a volume weight that is not positive");
    basis_->gradients(volume.points_m[i], dp);
    const Eigen::MatrixXd ds =
        massRoot_.triangularView<Eigen::Lower>().solve(dp.leftCols(dimension_));
    for (Eigen::Index j = 0; j < shapeCount_; ++j)
      for (Eigen::Index axis = 0; axis < dimension_; ++axis) slopes_.push_back(ds(j, axis));
    volumes_.push_back(count == 1 ? volume_m3_ : volume.weights[i]);
  }
  if (shapeCount_ >= kManyFunctions)
    table_ = std::make_shared<SlopeTable>(shapeCount_, dimension_, slopes_);
}

Eigen::VectorXd BodyShape::pointWeights(const Vec3& X) const {
  Eigen::VectorXd s(shapeCount_);
  pointWeights(X, s);
  return s;
}

void BodyShape::pointWeights(const Vec3& X, Eigen::Ref<Eigen::VectorXd> s) const {
  FASCIA_ASSERT(s.size() == shapeCount_ && X.allFinite(), "a weight for each shape");
  basis_->values(X, s);
  massRoot_.triangularView<Eigen::Lower>().solveInPlace(s);
}

Eigen::MatrixXd BodyShape::shapeMatrix(std::span<const double> q) const {
  Eigen::MatrixXd R(dimension_, shapeCount_);
  writeShapeMatrix(q, R);
  return R;
}

void BodyShape::writeShapeMatrix(std::span<const double> q, Eigen::Ref<Eigen::MatrixXd> R) const {
  FASCIA_ASSERT(q.size() == static_cast<std::size_t>(coordinateCount()),
                "the coordinates are of this body");
  // R L = q from the last column on; Eigen's own solver may allocate.
  R = Eigen::Map<const Eigen::MatrixXd>(q.data(), dimension_, shapeCount_);
  for (Eigen::Index j = shapeCount_; j-- > 0;) {
    for (Eigen::Index i = j + 1; i < shapeCount_; ++i) R.col(j) -= massRoot_(i, j) * R.col(i);
    R.col(j) /= massRoot_(j, j);
  }
}

void BodyShape::setShapeMatrix(const Eigen::MatrixXd& R, std::span<double> q) const {
  FASCIA_ASSERT(q.size() == static_cast<std::size_t>(coordinateCount()) && R.rows() == dimension_ &&
                    R.cols() == shapeCount_,
                "the coordinates are of this body");
  Eigen::Map<Eigen::MatrixXd>(q.data(), dimension_, shapeCount_) = R * massRoot_;
}

void BodyShape::setRest(const Transform& place, std::span<double> q) const {
  FASCIA_ASSERT(q.size() == static_cast<std::size_t>(coordinateCount()),
                "the coordinates are of this body");
  Eigen::Map<Eigen::MatrixXd>(q.data(), dimension_, shapeCount_) =
      place.rotation.topLeftCorner(dimension_, dimension_) * rest_ +
      place.translation_m.head(dimension_) * momentumWeights_.transpose();
}

void BodyShape::setRigidVelocity(std::span<const double> q, const Twist& twist,
                                 std::span<double> velocity) const {
  FASCIA_ASSERT(
      q.size() == velocity.size() && q.size() == static_cast<std::size_t>(coordinateCount()),
      "the coordinates are of this body");
  // ẋ = v + ω × (x − o) is a combination of the columns of q and of the constant function.
  const Vec3& w = twist.angular_rad_per_s;
  Mat3 turn;
  turn << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  const Vec3 atOrigin = twist.at(Vec3::Zero());
  const Eigen::Map<const Eigen::MatrixXd> Q(q.data(), dimension_, shapeCount_);
  Eigen::Map<Eigen::MatrixXd>(velocity.data(), dimension_, shapeCount_) =
      turn.topLeftCorner(dimension_, dimension_) * Q +
      atOrigin.head(dimension_) * momentumWeights_.transpose();
}

Vec3 BodyShape::point(std::span<const double> q, const Vec3& X) const {
  FASCIA_ASSERT(q.size() == static_cast<std::size_t>(coordinateCount()),
                "the coordinates are of this body");
  const Eigen::Map<const Eigen::MatrixXd> Q(q.data(), dimension_, shapeCount_);
  Vec3 x = Vec3::Zero();
  x.head(dimension_) = Q * pointWeights(X);
  return x;
}

Mat3 BodyShape::deformationGradient(std::span<const double> q, const Vec3& X) const {
  FASCIA_ASSERT(q.size() == static_cast<std::size_t>(coordinateCount()),
                "the coordinates are of this body");
  Eigen::MatrixXd dp(shapeCount_, 3);
  basis_->gradients(X, dp);
  Mat3 F = Mat3::Identity();
  F.topLeftCorner(dimension_, dimension_) = shapeMatrix(q) * dp.leftCols(dimension_);
  return F;
}

}  // namespace fascia
