#include <fascia/math/ode/adaptive_stepper.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include <fascia/base/assert.h>
#include <fascia/base/error.h>

namespace fascia {
namespace {

// Aiming below the tolerance spares the rejections that eq. (12) taken literally runs into.
constexpr double kSafety = 0.9;
// Bounds of the change from one step to the next: more makes the step size oscillate.
constexpr double kGrow = 5, kShrink = 0.1;
// Steps below this part of t would not move it: time would stand still.
constexpr double kResolution = 1e-15;
// Contacts found in one step before it is taken with the correction it has.
constexpr int kMaxContactRetries = 8;
// Repaired steps in a row after which longer ones are repaired too: forces that stay NaN must not
// make a frame cost step_max / step_min times as much.
constexpr int kMaxShortRepairs = 8;

void checkRange(bool ok, const char* name, double found, const char* expected) {
  if (ok) return;
  throw Error("stepper option " + std::string(name) + ": found " + std::to_string(found) +
              ", expected " + expected);
}

void check(const StepperOptions& o) {
  const auto positive = [](const char* name, double x) {
    checkRange(x > 0 && std::isfinite(x), name, x, "a positive number");
  };
  positive("tolerance", o.tolerance);
  positive("fixed_step_s", o.fixed_step_s);
  positive("step_min_s", o.step_min_s);
  positive("correction_limit_m", o.correction_limit_m);
  positive("move_limit_m", o.move_limit_m);
  positive("velocity_tolerance", o.integrator.velocity_tolerance);
  positive("position_scale.threshold", o.integrator.position_scale.threshold);
  positive("velocity_scale.threshold", o.integrator.velocity_scale.threshold);
  checkRange(o.step_max_s >= o.step_min_s && std::isfinite(o.step_max_s), "step_max_s",
             o.step_max_s, "a number not below step_min_s");
  checkRange(o.repair_damping >= 0 && o.repair_damping <= 1, "repair_damping", o.repair_damping,
             "a number in [0, 1]");
}

bool allFinite(std::span<const double> x) {
  FiniteCheck check;
  for (const double value : x) check.add(value);
  return check.allFinite();
}

// Cubic Hermite interpolation between two states, s in [0, 1].
void interpolate(const OdeState& a, const OdeState& b, double s, std::vector<double>& r) {
  FASCIA_ASSERT(a.r.size() == b.r.size() && s >= 0 && s <= 1, "between two states of one system");
  const double h = b.t_s - a.t_s, u = 1 - s;
  const double aR = u * u * (1 + 2 * s), aV = h * s * u * u;
  const double bR = s * s * (3 - 2 * s), bV = -h * s * s * u;
  r.resize(a.r.size());
  for (std::size_t i = 0; i < r.size(); ++i)
    r[i] = aR * a.r[i] + aV * a.v[i] + bR * b.r[i] + bV * b.v[i];
}

}  // namespace

AdaptiveStepper::AdaptiveStepper(std::unique_ptr<Integrator> integrator,
                                 const StepperOptions& options)
    : integrator_(std::move(integrator)) {
  setOptions(options);
  reset();
}

void AdaptiveStepper::setIntegrator(std::unique_ptr<Integrator> integrator) {
  FASCIA_ASSERT(integrator, "there is an integrator");
  integrator_ = std::move(integrator);
  integrator_->setSettings(options_.integrator);
}

void AdaptiveStepper::setOptions(const StepperOptions& options) {
  check(options);
  options_ = options;
  integrator_->setSettings(options.integrator);
}

void AdaptiveStepper::reset() {
  nextStep_s_ = options_.fixed_step_s;
  repairsInARow_ = 0;
  integrator_->reset();
}

void AdaptiveStepper::resume(double nextStep_s) {
  FASCIA_ASSERT(nextStep_s > 0, "a step lasts");
  reset();
  nextStep_s_ = nextStep_s;
}

void AdaptiveStepper::advance(SecondOrderSystem& system, OdeState& state, double target_s) {
  FASCIA_ASSERT(state.r.size() == system.size() && state.v.size() == system.size(),
                "the state fits the system");
  if (!std::isfinite(target_s) || !(state.t_s < target_s)) return;
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  measured_.wrap(system, stats_.cost);
  mendStart(state);
  while (state.t_s < target_s) step(measured_, state, target_s);
  stats_.total_s += std::chrono::duration<double>(Clock::now() - start).count();
}

// Equal steps up to the target rather than a sliver at its end; but none that t cannot resolve.
double AdaptiveStepper::firstTry(double remaining_s, double t_s) const {
  const double limit = integrator_->adaptive() ? options_.step_max_s : options_.fixed_step_s;
  const double wanted = std::max(std::min(nextStep_s_, limit), kResolution * std::abs(t_s));
  return remaining_s / std::max(1.0, std::ceil(remaining_s / wanted * (1 - 1e-9)));
}

void AdaptiveStepper::step(SecondOrderSystem& system, OdeState& state, double target_s) {
  const double remaining = target_s - state.t_s;
  const std::span<const double> w = system.inverseMass();
  FASCIA_ASSERT(w.size() == system.size(), "every coordinate has a mass");
  FASCIA_ASSERT(remaining > 0, "time goes on");
  double h = firstTry(remaining, state.t_s);
  const double shortest =
      std::min(h, std::max(options_.step_min_s, kResolution * std::abs(state.t_s)));

  for (int contacts = 0;;) {
    const bool last = !(h > shortest);
    const double error = integrator_->step(system, state, h, trial_);
    FASCIA_ASSERT(trial_.r.size() == state.r.size(), "a step keeps the number of coordinates");
    trial_.t_s = h < remaining ? state.t_s + h : target_s;
    if (const double next = shorter(state, w, h, error, last); next < h) {
      h = std::max(next, shortest);
      continue;
    }
    const double correction = constrain(system);
    if (correction > options_.correction_limit_m && !last && contacts++ < kMaxContactRetries) {
      const double touching = std::max(touchingStep(system, state, h), shortest);
      if (touching < h) {
        ++stats_.rejected_contact;
        h = touching;
        continue;
      }
    }
    return accept(state, h, error, correction);
  }
}

// What to try instead of a step that failed or is inaccurate; h if it is to be taken, mended if it
// is the last resort.
double AdaptiveStepper::shorter(const OdeState& from, std::span<const double> inverseMass, double h,
                                double error, bool last) {
  if (!sound(inverseMass, from, error)) {
    if (last || repairsInARow_ >= kMaxShortRepairs) {
      repair(inverseMass, from, h, error);
      return h;
    }
    ++stats_.rejected_failed;
    integrator_->reset();
    return 0.5 * h;
  }
  repairsInARow_ = 0;
  if (!(error > options_.tolerance)) return h;
  if (last) {
    ++stats_.forced_steps;
    return h;
  }
  ++stats_.rejected_inaccurate;
  return accurateStep(h, error);
}

bool AdaptiveStepper::sound(std::span<const double> inverseMass, const OdeState& from,
                            double error) const {
  if (!std::isfinite(error)) return false;
  // No early way out: the loop then runs on vectors, on which signs are told apart for nothing.
  const double limit = options_.move_limit_m;
  const double *w = inverseMass.data(), *before = from.r.data();
  const double *r = trial_.r.data(), *v = trial_.v.data();
  FiniteCheck check;
  std::uint64_t runaway = 0;
  for (std::size_t i = 0; i < from.r.size(); ++i) {
    const double move = std::abs(r[i] - before[i]);
    check.add(move), check.add(v[i]);
    runaway |= std::bit_cast<std::uint64_t>(limit - move) & std::bit_cast<std::uint64_t>(0 - w[i]);
  }
  return check.allFinite() && runaway >> 63 == 0;
}

// Projects the trial and keeps in free_ what it was. Returns the correction.
double AdaptiveStepper::constrain(SecondOrderSystem& system) {
  free_.t_s = trial_.t_s;
  free_.r = trial_.r, free_.v = trial_.v;
  const double correction = system.project(trial_.t_s, trial_.r, trial_.v);
  if (std::isfinite(correction) && allFinite(trial_.r) && allFinite(trial_.v)) return correction;
  std::swap(trial_, free_);
  ++stats_.repaired_steps;
  return 0;
}

// Makes the trial finite and slower: coordinates that the step spoiled go on with the velocity that
// they had, and all free ones lose some of theirs, because what ran away had sound neighbours.
void AdaptiveStepper::repair(std::span<const double> inverseMass, const OdeState& from, double h,
                             double error) {
  const double limit = options_.move_limit_m;
  const bool failed = error == kStepFailed;
  for (std::size_t i = 0; i < from.r.size(); ++i) {
    const bool isFree = inverseMass[i] > 0;
    const double move = std::abs(trial_.r[i] - from.r[i]);
    const bool spoiled =
        failed || !std::isfinite(move) || !std::isfinite(trial_.v[i]) || (isFree && move > limit);
    if (spoiled) {
      const double ballistic = h * from.v[i];
      trial_.r[i] = from.r[i] + (isFree ? std::clamp(ballistic, -limit, limit) : ballistic);
      trial_.v[i] = from.v[i];
      if (!std::isfinite(trial_.r[i])) trial_.r[i] = from.r[i];
      ++stats_.repaired_coordinates;
    }
    if (isFree) trial_.v[i] *= options_.repair_damping;
  }
  ++stats_.repaired_steps;
  ++repairsInARow_;
  integrator_->reset();
}

// A start that is not finite has no better place than the origin; the skin above knows one.
void AdaptiveStepper::mendStart(OdeState& state) {
  for (std::vector<double>* values : {&state.r, &state.v}) {
    for (double& x : *values) {
      if (std::isfinite(x)) continue;
      x = 0;
      ++stats_.repaired_coordinates;
    }
  }
}

// The step after which the deepest point is inside by no more than the limit, but does touch (root
// bracketing of §4.2.3). The path is interpolated, so that bracketing costs no force evaluations.
// Returns h if a shorter step would not help: the start was inside already, or the system has no
// violation().
double AdaptiveStepper::touchingStep(SecondOrderSystem& system, const OdeState& from, double h) {
  const double limit = options_.correction_limit_m;
  if (system.violation(from.t_s, from.r) > limit) return h;
  if (!(system.violation(free_.t_s, free_.r) > limit)) return h;
  double low = 0, high = h;
  while (high - low > 1e-3 * options_.step_min_s && high > options_.step_min_s) {
    const double middle = 0.5 * (low + high);
    if (!(low < middle && middle < high)) break;
    interpolate(from, free_, middle / h, between_);
    const double depth = system.violation(from.t_s + middle, between_);
    if (depth > limit) {
      high = middle;
    } else {
      low = middle;
      if (depth > 0) break;
    }
  }
  return low > 0 ? low : high;
}

// Eq. (12), h₁ = h (Δ/ε)^(−1/2), for pairs of any order: the embedded formula of order q has a
// local error of O(h^(q+1)).
double AdaptiveStepper::accurateStep(double h, double error) const {
  FASCIA_ASSERT(h > 0, "steps go forward");
  const double exponent = -1.0 / (integrator_->embeddedOrder() + 1);
  const double ratio = error / options_.tolerance;
  const double factor = ratio > 0 ? kSafety * std::pow(ratio, exponent) : kGrow;
  return h * std::clamp(factor, kShrink, kGrow);
}

void AdaptiveStepper::accept(OdeState& state, double h, double error, double correction_m) {
  FASCIA_ASSERT(h > 0 && trial_.t_s > state.t_s, "an accepted step goes forward");
  FASCIA_ASSERT(allFinite(trial_.r) && allFinite(trial_.v), "an accepted step is finite");
  std::swap(state, trial_);
  ++stats_.steps;
  stats_.step_min_s = std::min(stats_.step_min_s, h);
  stats_.step_max_s = std::max(stats_.step_max_s, h);
  stats_.largest_correction_m = std::max(stats_.largest_correction_m, correction_m);
  if (integrator_->adaptive()) {
    const double knownError = std::isfinite(error) ? error : 0;
    nextStep_s_ = std::clamp(accurateStep(h, knownError), options_.step_min_s, options_.step_max_s);
  } else {
    nextStep_s_ = std::min(kGrow * h, options_.fixed_step_s);
  }
}

}  // namespace fascia
