#include <fascia/deformable/solve/constraint_list.h>

#include <algorithm>

#include <fascia/base/assert.h>

namespace fascia {

void ConstraintList::clear() {
  constraints_.clear(), rowCounts_.clear(), terms_.clear(), weights_.clear(), rows_.clear();
  derivatives_.clear();
  firstTerm_.assign(1, 0);
  termsOfBodies_.assign(model_->bodyCount(), {});
  constantJacobian_ = true, knowsJacobian_ = false;
}

void ConstraintList::add(const Constraint& constraint) {
  const auto index = static_cast<int>(constraints_.size());
  termsOfBodies_.resize(model_->bodyCount());
  for (const BodyPoint& point : constraint.points()) {
    const Eigen::VectorXd s = model_->shape(point.body).pointWeights(point.X_m);
    termsOfBodies_[point.body.index()].push_back(static_cast<int>(terms_.size()));
    terms_.push_back({point.body, model_->offset(point.body), weights_.size(),
                      static_cast<int>(s.size()), index});
    weights_.insert(weights_.end(), s.begin(), s.end());
  }
  constraints_.push_back(&constraint);
  rowCounts_.push_back(constraint.rowCount(model_->dimension()));
  firstTerm_.push_back(static_cast<int>(terms_.size()));
  rows_.emplace_back();
  derivatives_.resize(terms_.size(), Mat3::Zero());
  knowsJacobian_ = false;
  constantJacobian_ = constantJacobian_ && constraint.hasConstantJacobian();
}

Vec3 ConstraintList::pointValue(const ConstraintTerm& term, std::span<const double> q) const {
  FASCIA_ASSERT(
      term.offset + static_cast<std::size_t>(term.weightCount * model_->dimension()) <= q.size(),
      "the coordinates hold the term's body");
  const double* s = weights(term);
  const double* at = q.data() + term.offset;
  Vec3 x = Vec3::Zero();
  if (model_->dimension() == 3) {
    for (int j = 0; j < term.weightCount; ++j)
      for (int row = 0; row < 3; ++row) x[row] += at[3 * j + row] * s[j];
  } else {
    for (int j = 0; j < term.weightCount; ++j)
      for (int row = 0; row < 2; ++row) x[row] += at[2 * j + row] * s[j];
  }
  return x;
}

void ConstraintList::evaluate(double t_s, std::span<const double> q, std::span<const double> v) {
  Vec3 x[kMaxConstraintPoints], velocity[kMaxConstraintPoints];
  const bool wanted = !constantJacobian_ || !knowsJacobian_;
  for (std::size_t i = 0; i < constraints_.size(); ++i) {
    const auto first = static_cast<std::size_t>(firstTerm_[i]);
    const std::size_t count = static_cast<std::size_t>(firstTerm_[i + 1]) - first;
    FASCIA_ASSERT(count >= 1 && count <= kMaxConstraintPoints, "a constraint holds a few points");
    for (std::size_t p = 0; p < count; ++p) {
      x[p] = pointValue(terms_[first + p], q);
      // Constant Jacobians leave nothing of c̈ that depends on velocities.
      velocity[p] =
          constantJacobian_ || v.empty() ? Vec3(0, 0, 0) : pointValue(terms_[first + p], v);
    }
    rows_[i] = {};
    if (wanted) {
      rows_[i].jacobian = std::span(derivatives_).subspan(first, count);
      std::ranges::fill(rows_[i].jacobian, Mat3::Zero());
    }
    constraints_[i]->evaluate(t_s, {x, count}, {velocity, count}, rows_[i]);
    clearMissing(i);
  }
  knowsJacobian_ = true;
}

// Rows and columns that there are not: a constraint may write all of them.
void ConstraintList::clearMissing(std::size_t i) {
  ConstraintRows& rows = rows_[i];
  for (int row = rowCounts_[i]; row < 3; ++row) {
    rows.value[row] = rows.rate_m_per_s[row] = rows.acceleration_m_per_s2[row] = 0;
    for (Mat3& derivative : rows.jacobian) derivative.row(row).setZero();
  }
  if (model_->dimension() == 3) return;
  for (Mat3& derivative : rows.jacobian) derivative.col(2).setZero();
}

Vec3 ConstraintList::jacobianTimes(std::size_t i, std::span<const double> v) const {
  FASCIA_ASSERT(i < constraints_.size() && knowsJacobian_, "the constraint was evaluated");
  Vec3 sum = Vec3::Zero();
  for (int p = firstTerm_[i]; p < firstTerm_[i + 1]; ++p)
    sum.noalias() += derivatives_[p] * pointValue(terms_[static_cast<std::size_t>(p)], v);
  return sum;
}

void ConstraintList::addTransposed(std::size_t i, const Vec3& lambda, std::span<double> f) const {
  FASCIA_ASSERT(i < constraints_.size() && knowsJacobian_, "the constraint was evaluated");
  const int d = model_->dimension();
  for (int p = firstTerm_[i]; p < firstTerm_[i + 1]; ++p) {
    const ConstraintTerm& term = terms_[static_cast<std::size_t>(p)];
    const Vec3 force = derivatives_[p].transpose() * lambda;
    const double* s = weights(term);
    double* at = f.data() + term.offset;
    if (d == 3) {
      for (int j = 0; j < term.weightCount; ++j)
        for (int row = 0; row < 3; ++row) at[3 * j + row] += force[row] * s[j];
    } else {
      for (int j = 0; j < term.weightCount; ++j)
        for (int row = 0; row < 2; ++row) at[2 * j + row] += force[row] * s[j];
    }
  }
}

std::vector<std::pair<int, int>> ConstraintList::coupledPairs() const {
  std::vector<std::pair<int, int>> pairs;
  for (const std::vector<int>& terms : termsOfBodies_) {
    for (const int a : terms) {
      for (const int b : terms) {
        const int i = terms_[static_cast<std::size_t>(a)].constraint,
                  j = terms_[static_cast<std::size_t>(b)].constraint;
        if (i > j) pairs.emplace_back(i, j);
      }
    }
  }
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace fascia
