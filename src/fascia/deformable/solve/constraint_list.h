#pragma once

#include <span>
#include <utility>
#include <vector>

#include <fascia/deformable/body/body_model.h>
#include <fascia/deformable/constraint/constraint.h>

namespace fascia {

// A point of a constraint: x = Σ_j q_j weights_j of one body.
struct ConstraintTerm {
  BodyId body;
  std::size_t offset = 0;       // of the body's coordinates
  std::size_t weightFirst = 0;  // its weights, in ConstraintList
  int weightCount = 0;
  int constraint = 0;  // whose point it is
};

// Constraints on the bodies of a model in evaluated form: their values, and products with their
// Jacobian J without ever forming it. J's block for a constraint and a body is D ⊗ sᵀ, with the
// constraint's derivative D by its point and the point's weights s (§3.3: δ_ir p_s).
class ConstraintList {
 public:
  explicit ConstraintList(const BodyModel& model) : model_(&model) {}

  void clear();
  void add(const Constraint& constraint);  // which must outlive its stay here
  std::size_t size() const { return constraints_.size(); }
  bool hasConstantJacobian() const { return constantJacobian_; }
  int rowCount(std::size_t i) const { return rowCounts_[i]; }
  const Constraint& constraint(std::size_t i) const { return *constraints_[i]; }

  // Evaluates all at one moment; `v` may be empty for bodies at rest. Constant Jacobians are kept
  // from the first time. Rows that a constraint does not have are 0 from here on.
  void evaluate(double t_s, std::span<const double> q, std::span<const double> v);
  const ConstraintRows& rows(std::size_t i) const { return rows_[i]; }

  Vec3 jacobianTimes(std::size_t i, std::span<const double> v) const;  // J v, rows of i
  void addTransposed(std::size_t i, const Vec3& lambda, std::span<double> f) const;  // f += Jᵀ λ

  // Points by body, for the products J W Jᵀ.
  std::span<const ConstraintTerm> terms() const { return terms_; }
  const std::vector<std::vector<int>>& termsOfBodies() const { return termsOfBodies_; }
  const Mat3& derivative(int term) const { return derivatives_[term]; }  // D
  const double* weights(const ConstraintTerm& term) const {
    return weights_.data() + term.weightFirst;
  }
  // Pairs of constraints (i > j) that share a body.
  std::vector<std::pair<int, int>> coupledPairs() const;

 private:
  Vec3 pointValue(const ConstraintTerm& term, std::span<const double> q) const;
  void clearMissing(std::size_t i);

  const BodyModel* model_;
  std::vector<const Constraint*> constraints_;
  std::vector<int> rowCounts_, firstTerm_{0};  // firstTerm_: size() + 1
  std::vector<ConstraintTerm> terms_;
  std::vector<double> weights_;
  std::vector<std::vector<int>> termsOfBodies_;
  std::vector<ConstraintRows> rows_;
  std::vector<Mat3> derivatives_;  // of each term
  bool constantJacobian_ = true, knowsJacobian_ = false;
};

}  // namespace fascia
