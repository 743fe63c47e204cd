#pragma once

#include <cstdint>
#include <memory>

#include <fascia/deformable/solve/body_system.h>

namespace fascia {

// How a step goes from q, v to q⁺, v⁺ in the time h. All three end with c(q⁺, t + h) = 0: exactly
// for constraints that are linear, so that nothing drifts, and to the tolerance for others.
enum class BodyScheme {
  // v⁺ = v + h Q(q, v) made legal, q⁺ = q + h v⁺ (symplectic Euler). The paper's case: the constant
  // matrix is factored once and a step costs a back-substitution. First order, keeps energy in
  // bounds; stable while h ω < 2 for the highest frequency ω of the bodies.
  explicitEuler,
  // Newton's method on v⁺ = v + h Q(q⁺, v⁺): stable at any stiffness, first order, damps.
  implicitEuler,
  // q⁺ = q + h v̄, v̄ = (v + v⁺)/2, with the mean force along the way from q to q⁺ (the average
  // vector
  // field method, Quispel & McLaren 2008): second order, and the energy of the bodies is kept to
  // the
  // tolerance, whatever the step. Fast swings of stiff bodies are not damped, only slowed.
  energyConserving,
};

struct BodyStepperOptions {
  BodyScheme scheme = BodyScheme::implicitEuler;
  // Newton's corrections below this part of a body's size end a step.
  double tolerance = 1e-10;  // (0, 1)
  // The same for steps in which there are contacts, whose gaps are a hundredth of a body. What
  // slides slowly comes to rest in a long tail of small corrections: after so many iterations those
  // below a thousandth end the step too. Larger: slides and blows are more exact, and dearer.
  double contact_tolerance = 1e-4;  // (0, 1)
  int contact_patience = 12;        // [1, 1000]
  int max_iterations = 30;          // [1, 1000]; with 1 a step is linearly implicit: the cheapest
};

struct BodyStepperStats {
  std::uint64_t steps = 0;       // taken, parts of halved ones included
  std::uint64_t iterations = 0;  // of Newton's method
  std::uint64_t halved = 0;      // steps that did not converge and were taken in two parts
  // Accepted above the tolerance: at the smallest part, or because of contacts and nearly there.
  std::uint64_t unconverged = 0;
  std::uint64_t stopped = 0;  // not finite even then: everything stands still instead
};

// Takes BodySystems through time in fixed steps. Allocates when the constraints have changed, only.
class BodyStepper {
 public:
  // Throws Error if an option is out of its range, or if the system has contacts and the scheme is
  // not implicitEuler, the only one that knows them. The system must outlive the stepper.
  explicit BodyStepper(BodySystem& system, const BodyStepperOptions& options = {});
  ~BodyStepper();

  // h_s > 0. Never leaves a state that is not finite, if it was.
  void step(double h_s, OdeState& state);

  const BodyStepperOptions& options() const { return options_; }
  const BodyStepperStats& stats() const { return stats_; }

 private:
  enum class Outcome { converged, near, unconverged, failed };
  // lead_s: from the end of this part to that of the whole step.
  void stepOrHalve(double h_s, double lead_s, OdeState& state, int halvingsLeft);
  Outcome tryStep(double h_s, double lead_s, const OdeState& from, OdeState& to);
  void explicitStep(double h_s, const OdeState& from, OdeState& to);

  BodySystem& system_;
  BodyStepperOptions options_;
  BodyStepperStats stats_;
  OdeState from_, to_;
  std::unique_ptr<class BodyNewton> newton_;
};

}  // namespace fascia
