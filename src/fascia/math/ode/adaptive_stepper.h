#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include <fascia/math/ode/integrator.h>
#include <fascia/math/ode/measured_system.h>

namespace fascia {

struct StepperOptions {
  double tolerance = 1e-3;           // ε_r > 0: scaled position error of a step (see ErrorScale)
  double fixed_step_s = 1e-3;        // > 0; first step of adaptive methods, every step of others
  double step_min_s = 1e-5;          // > 0; a step this short is taken whatever its error
  double step_max_s = 1.0 / 24;      // >= step_min_s
  double correction_limit_m = 1e-2;  // ε_c > 0: larger pushes out of solids shorten the step
  double move_limit_m = 10;          // > 0; a free coordinate that moves farther is a runaway
  double repair_damping = 0.5;       // [0, 1]: what a repair leaves of the velocities
  IntegratorSettings integrator;
};

struct StepperStats {
  std::uint64_t steps = 0;                // accepted
  std::uint64_t rejected_inaccurate = 0;  // error above the tolerance
  std::uint64_t rejected_contact = 0;     // correction above its limit
  std::uint64_t rejected_failed = 0;      // not finite, runaway, or no convergence
  std::uint64_t forced_steps = 0;         // accepted at step_min_s though inaccurate
  std::uint64_t repaired_steps = 0;       // accepted after mending, never with NaN
  std::uint64_t repaired_coordinates = 0;
  double step_min_s = std::numeric_limits<double>::infinity(), step_max_s = 0;
  double largest_correction_m = 0;  // by project(), of accepted steps
  SystemCost cost;
  double total_s = 0;  // wall clock in advance()

  std::uint64_t rejected() const {
    return rejected_inaccurate + rejected_contact + rejected_failed;
  }
};

// Integrates a system over time with step-size control (Turner & Gobbetti 1998, §4.2.2–4.2.3) and
// with a promise: what comes out is finite, whatever the forces do.
class AdaptiveStepper {
 public:
  // Throws Error if an option is out of its range.
  AdaptiveStepper(std::unique_ptr<Integrator> integrator, const StepperOptions& options);

  // Both may be called while running. The step size is kept; the next rejections adapt it.
  void setIntegrator(std::unique_ptr<Integrator> integrator);
  void setOptions(const StepperOptions& options);

  // Integrates from state.t_s to target_s; nothing if target_s is not later and finite.
  void advance(SecondOrderSystem& system, OdeState& state, double target_s);

  // Forgets step size and warm starts: the same state then gives the same bits again.
  void reset();
  // The same, but goes on with the step that nextStep_s() said when the state was left.
  void resume(double nextStep_s);

  const Integrator& integrator() const { return *integrator_; }
  const StepperOptions& options() const { return options_; }
  double nextStep_s() const { return nextStep_s_; }
  const StepperStats& stats() const { return stats_; }
  void resetStats() { stats_ = {}; }

 private:
  void step(SecondOrderSystem& system, OdeState& state, double target_s);
  double firstTry(double remaining_s, double t_s) const;
  bool sound(std::span<const double> inverseMass, const OdeState& from, double error) const;
  double shorter(const OdeState& from, std::span<const double> inverseMass, double h_s,
                 double error, bool last);
  double constrain(SecondOrderSystem& system);
  void repair(std::span<const double> inverseMass, const OdeState& from, double h_s, double error);
  void mendStart(OdeState& state);
  double touchingStep(SecondOrderSystem& system, const OdeState& from, double h_s);
  double accurateStep(double h_s, double error) const;
  void accept(OdeState& state, double h_s, double error, double correction_m);

  std::unique_ptr<Integrator> integrator_;
  StepperOptions options_;
  StepperStats stats_;
  double nextStep_s_ = 0;
  int repairsInARow_ = 0;
  OdeState trial_, free_;        // after the step; before project() moved it
  std::vector<double> between_;  // positions within the step, while bracketing
  MeasuredSystem measured_;
};

}  // namespace fascia
