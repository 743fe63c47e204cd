#pragma once

#include <optional>
#include <vector>

#include <fascia/deformable/contact/body_contact.h>
#include <fascia/deformable/solve/body_stepper.h>
#include <fascia/deformable/solve/small_dense.h>

namespace fascia {

// One implicit step of a BodySystem by Newton's method. The unknown is the way Δ = q⁺ − q. In every
// iteration each body has a small dense matrix of its own,
//     A = inertia + stiffness + damping,   A δ = −residual + Jᵀ λ,
// and the constraints tie the corrections δ together by
//     (J A⁻¹ Jᵀ + 1/K) λ = −c + J A⁻¹ residual
// with a compliance 1/K where a constraint is soft. A changes with the bodies' shapes, so this
// matrix is factored in every iteration; its pattern and the order of elimination stay. Contacts
// add to A; those between bodies also couple them, which conjugate gradients see to. Without
// contacts large bodies keep the factorisation of an iteration for those after it, as long as
// corrections shrink well.
class BodyNewton {
 public:
  BodyNewton(BodySystem& system, const BodyStepperOptions& options);

  struct Result {
    bool sound = false, converged = false;
    bool near = false;      // as near to the tolerance as contacts are worth
    double correction = 0;  // the last one's largest part of a body's size
    int iterations = 0;
  };
  // Allocates when the constraints have changed. `to` is sized; its t_s is the end of the step,
  // lead_s before the moment at which obstacles are posed.
  Result solve(const OdeState& from, double h_s, double lead_s, OdeState& to);

 private:
  // Everything of one body that an iteration writes.
  struct Work {
    Eigen::MatrixXd matrix, damping;  // A, and D at the start of the step; n × n
    Eigen::MatrixXd trial;            // n × n, to see whether a part of A is positive
    // What the body answers to its own forces (column 0) and to unit forces at its terms' points
    // (dimension columns each): A⁻¹ residual, A⁻¹ (s ⊗ I); n rows.
    RowMatrix response;
    RowMatrix inverse;  // A⁻¹, for conjugate gradients; padded columns
    // The same at its terms' points, (s ⊗ I)ᵀ of it; dimension rows for each term.
    RowMatrix atTerms;
    Eigen::VectorXd residual, q, force;  // n
    std::vector<int> terms;              // numbers in constraints_
    double merit_J = 0;                  // part of the merit
    double correction = 0;               // |δ| relative to the body's size
    double correctionBefore = 0;         // that of the iteration before
    bool factored = false;               // matrix, in this step
    bool sound = true;
  };

  void refresh();
  double iterate(const OdeState& from, double h_s, double t_s);
  void guess(const OdeState& from, double h_s, double t_s);
  void evaluateConstraints(const OdeState& from, double t_s);
  void linearize(BodyId body, const OdeState& from, double h_s);
  void moveTo(BodyId body, const OdeState& from, double place);
  bool factor(BodyId body, const OdeState& from, double h_s);
  void respond(Work& work) const;
  bool mayKeep(const Work& work) const;
  void respondToResidual(Work& work) const;
  bool solveConstraints(double h_s);
  Vec3 wanted(std::size_t constraint, double h_s) const;
  void correct(BodyId body);
  void measure(BodyId body);
  void applyCorrections(const OdeState& from, double h_s, double t_s);
  double merit(const OdeState& from, double h_s, double t_s, double step);
  double bodyMerit(BodyId body, const OdeState& from, double h_s, double step);
  bool isHard(std::size_t constraint) const { return constraint < hardCount_; }
  double gain(std::size_t softIndex, double h_s) const;
  // body_newton_contact.cpp
  void findContacts(const OdeState& from, double h_s, double lead_s);
  void evaluateContacts(int iteration);
  bool addContacts(BodyId body);
  void coupleContacts();
  void precondition(std::span<const double> residual, std::span<double> z);

  BodySystem& system_;
  const BodyStepperOptions options_;
  const bool conserving_;
  const LineRule rule_;  // over the way, of the force
  int version_ = -1;
  std::size_t hardCount_ = 0;
  ConstraintList constraints_;  // those held, then the soft ones
  BlockCholesky matrix_;
  std::vector<Work> work_;
  std::vector<double> way_, correction_, place_;  // Δ, δ, where something is evaluated
  std::span<const double> constantForces_;
  std::vector<Vec3> lambda_, startValue_, endValue_;  // of all constraints
  ContactSet* contacts_ = nullptr;                    // of this step, if there are any
  std::optional<double> lastMerit_;                   // where the way is, if it is known
  // Of the conjugate gradients: ρ, z, p, A p but for the coupling, and with it.
  std::vector<double> cgResidual_, cgAnswer_, cgDirection_, cgImage_, cgProduct_;
};

}  // namespace fascia
