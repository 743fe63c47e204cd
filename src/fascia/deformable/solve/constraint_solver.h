#pragma once

#include <span>
#include <vector>

#include <fascia/deformable/solve/block_cholesky.h>
#include <fascia/deformable/solve/constraint_list.h>
#include <fascia/deformable/solve/redundancy.h>

namespace fascia {

// Forces and impulses of constraints: solves J W Jᵀ λ = b (Witkin & Welch 1990, eqs. 8–10) with
// W = I in mass-normalised coordinates. The matrix of linear constraints is constant: it is
// factored when the set of constraints changes, and a solution is a back-substitution, of a cost
// in proportion to the number of bodies in chains and trees.
class ConstraintSolver {
 public:
  explicit ConstraintSolver(const BodyModel& model) : list_(model) {}

  // Allocates all there is to allocate; the constraints must outlive their stay here.
  void setConstraints(std::span<const ConstraintPtr> constraints);

  // Evaluates the constraints, and factors their matrix if it is new or not constant. `v` may be
  // empty: bodies at rest.
  void update(double t_s, std::span<const double> q, std::span<const double> v);

  const ConstraintList& list() const { return list_; }
  bool empty() const { return list_.size() == 0; }
  int factorizationCount() const { return factorizationCount_; }
  const BlockCholesky& matrix() const { return matrix_; }
  const Redundancies& dependences() const { return redundancies_; }
  // At the last update().
  std::vector<Redundancy> redundancies() const { return redundancies_.describe(list_); }

  // f += Jᵀ λ with J W Jᵀ λ = b: changes J f by b(i) for all constraints i at once. b is a function
  // of the number of a constraint that returns its three rows.
  template <class Change>
  void change(std::span<double> f, Change&& b) {
    for (std::size_t i = 0; i < list_.size(); ++i) lambda_[i] = b(i);
    solve(lambda_);
    for (std::size_t i = 0; i < list_.size(); ++i) list_.addTransposed(i, lambda_[i], f);
  }
  // The same so that J f = b(i) then. In coordinates with W = I this is a projection, of
  // accelerations, velocities or places alike.
  template <class Wanted>
  void project(std::span<double> f, Wanted&& b) {
    change(f, [&](std::size_t i) -> Vec3 { return b(i) - list_.jacobianTimes(i, f); });
  }
  // λ of the last change(): the forces (N) or impulses (N s) of the constraints' rows.
  std::span<const Vec3> lambda() const { return lambda_; }

 private:
  void assemble();
  void solve(std::span<Vec3> b) const;

  ConstraintList list_;
  BlockCholesky matrix_;
  Redundancies redundancies_;
  std::vector<Vec3> lambda_;
  bool factored_ = false;
  int factorizationCount_ = 0;
};

}  // namespace fascia
