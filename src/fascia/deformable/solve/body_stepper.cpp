#include <fascia/deformable/solve/body_stepper.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <fascia/base/assert.h>
#include <fascia/base/error.h>
#include <fascia/deformable/solve/body_newton.h>

namespace fascia {
namespace {

// A step that does not converge in 1/16 of its length will not in less.
constexpr int kMaxTimeHalvings = 4;

void checkOption(bool sound, const char* what, double found, const char* expected) {
  if (sound) return;
  Issue issue{{},
              "body stepper: " + std::string(what) + ": found " + std::to_string(found) +
                  ", expected " + expected,
              {}};
  throw Error(issue);
}

bool allFinite(const OdeState& state) {
  const auto finite = [](double x) { return std::isfinite(x); };
  return std::ranges::all_of(state.r, finite) && std::ranges::all_of(state.v, finite);
}

}  // namespace

BodyStepper::BodyStepper(BodySystem& system, const BodyStepperOptions& options)
    : system_(system), options_(options) {
  checkOption(options.tolerance > 0 && options.tolerance < 1, "tolerance", options.tolerance,
              "a number in (0, 1)");
  checkOption(options.contact_tolerance > 0 && options.contact_tolerance < 1, "contact_tolerance",
              options.contact_tolerance, "a number in (0, 1)");
  checkOption(options.contact_patience >= 1 && options.contact_patience <= 1000, "contact_patience",
              options.contact_patience, "a number in [1, 1000]");
  checkOption(options.max_iterations >= 1 && options.max_iterations <= 1000, "max_iterations",
              options.max_iterations, "a number in [1, 1000]");
  if (system.contacts() && options.scheme != BodyScheme::implicitEuler)
    throw Error("body stepper: found contacts, which only the implicit Euler scheme knows");
  from_.resize(system.size()), to_.resize(system.size());
  if (options.scheme != BodyScheme::explicitEuler)
    newton_ = std::make_unique<BodyNewton>(system, options);
}

BodyStepper::~BodyStepper() = default;

void BodyStepper::step(double h_s, OdeState& state) {
  FASCIA_ASSERT(h_s > 0, "time goes on");
  FASCIA_ASSERT(state.r.size() == system_.size() && state.v.size() == system_.size(),
                "the state is of these bodies");
  stepOrHalve(h_s, 0, state, kMaxTimeHalvings);
}

void BodyStepper::stepOrHalve(double h_s, double lead_s, OdeState& state, int halvingsLeft) {
  const Outcome outcome = tryStep(h_s, lead_s, state, to_);
  const bool finite = outcome != Outcome::failed && allFinite(to_);
  // One Newton step is all that was asked for.
  const bool single = options_.max_iterations == 1;
  const bool done = outcome == Outcome::converged || outcome == Outcome::near;
  if (finite && (done || single || halvingsLeft == 0)) {
    if (outcome != Outcome::converged && !single) ++stats_.unconverged;
    FASCIA_ASSERT(to_.t_s > state.t_s, "a step goes forward");
    ++stats_.steps;
    std::swap(state, to_);
  } else if (halvingsLeft > 0) {
    ++stats_.halved;
    stepOrHalve(0.5 * h_s, lead_s + 0.5 * h_s, state, halvingsLeft - 1);
    stepOrHalve(0.5 * h_s, lead_s, state, halvingsLeft - 1);
  } else {
    ++stats_.stopped;
    state.t_s += h_s;
    std::ranges::fill(state.v, 0.0);
  }
}

BodyStepper::Outcome BodyStepper::tryStep(double h_s, double lead_s, const OdeState& from,
                                          OdeState& to) {
  to.resize(system_.size());
  to.t_s = from.t_s + h_s;
  if (!newton_) {
    explicitStep(h_s, from, to);
    return Outcome::converged;
  }
  const BodyNewton::Result result = newton_->solve(from, h_s, lead_s, to);
  stats_.iterations += static_cast<std::uint64_t>(result.iterations);
  if (!result.sound) return Outcome::failed;
  if (result.converged) return Outcome::converged;
  return result.near ? Outcome::near : Outcome::unconverged;
}

void BodyStepper::explicitStep(double h_s, const OdeState& from, OdeState& to) {
  const std::span<double> v = to.v;
  system_.evaluateFreeForces(from, v);
  for (std::size_t i = 0; i < v.size(); ++i) v[i] = from.v[i] + h_s * v[i];
  // Where the bodies would go by themselves, what is missing there, and the velocities that make up
  // for it: exact if c is linear, Newton's step if not.
  for (std::size_t i = 0; i < v.size(); ++i) to.r[i] = from.r[i] + h_s * v[i];
  ConstraintSolver& constraints = system_.constraints();
  constraints.update(to.t_s, to.r, v);
  constraints.change(
      v, [&](std::size_t i) -> Vec3 { return -constraints.list().rows(i).value / h_s; });
  for (std::size_t i = 0; i < v.size(); ++i) to.r[i] = from.r[i] + h_s * v[i];
}

}  // namespace fascia
