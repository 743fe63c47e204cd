#include <fascia/deformable/solve/constraint_solver.h>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

// Pivots below this part of their diagonal entry are what rounding leaves of a dependent row.
constexpr double kDependent = 1e-10;

}  // namespace

void ConstraintSolver::setConstraints(std::span<const ConstraintPtr> constraints) {
  list_.clear();
  for (const ConstraintPtr& constraint : constraints) list_.add(*constraint);
  matrix_.setPattern(list_.size(), list_.coupledPairs());
  lambda_.assign(list_.size(), Vec3::Zero());
  redundancies_ = {};
  factored_ = false;
}

void ConstraintSolver::update(double t_s, std::span<const double> q, std::span<const double> v) {
  if (empty()) return;
  list_.evaluate(t_s, q, v);
  FASCIA_ASSERT(lambda_.size() == list_.size(), "a force for each constraint");
  if (factored_ && list_.hasConstantJacobian()) return;
  assemble();
  matrix_.factorizeAndFindDependent(kDependent);
  ++factorizationCount_;
  // Names are found once: dependences that come and go while bodies move are left to the pivots.
  if (!factored_) redundancies_.find(matrix_, list_);
  factored_ = true;
}

void ConstraintSolver::assemble() {
  matrix_.setZero();
  const std::span<const ConstraintTerm> terms = list_.terms();
  for (const std::vector<int>& ofBody : list_.termsOfBodies()) {
    for (const int a : ofBody) {
      for (const int b : ofBody) {
        const ConstraintTerm& termA = terms[static_cast<std::size_t>(a)];
        const ConstraintTerm& termB = terms[static_cast<std::size_t>(b)];
        if (termA.constraint < termB.constraint) continue;
        double weight = 0;  // s_a · s_b, as W = I
        for (int j = 0; j < termA.weightCount; ++j)
          weight += list_.weights(termA)[j] * list_.weights(termB)[j];
        matrix_.add(termA.constraint, termB.constraint,
                    weight * list_.derivative(a) * list_.derivative(b).transpose());
      }
    }
  }
  for (std::size_t i = 0; i < list_.size(); ++i) {
    Mat3 padding = Mat3::Zero();
    for (int row = list_.rowCount(i); row < 3; ++row) padding(row, row) = 1;
    matrix_.add(static_cast<int>(i), static_cast<int>(i), padding);
  }
}

void ConstraintSolver::solve(std::span<Vec3> b) const {
  FASCIA_ASSERT(b.size() == list_.size() && (factored_ || empty()),
                "the matrix of these constraints is there");
  if (list_.hasConstantJacobian()) redundancies_.makeSolvable(b);
  matrix_.solve(b);
}

}  // namespace fascia
