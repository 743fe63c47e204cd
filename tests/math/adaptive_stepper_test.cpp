#include <fascia/math/ode/adaptive_stepper.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include <fascia/base/error.h>

#include "ode_systems.h"

namespace fascia {
namespace {

using namespace test;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

StepperOptions absoluteOptions(double tolerance) {
  StepperOptions options;
  options.tolerance = tolerance;
  options.integrator = tightSettings();
  options.step_max_s = 1;
  return options;
}

bool allFinite(const OdeState& s) {
  for (const auto* values : {&s.r, &s.v}) {
    for (const double x : *values) {
      if (!std::isfinite(x)) return false;
    }
  }
  return std::isfinite(s.t_s);
}

double keplerError(std::string_view method, double tolerance, StepperStats& stats) {
  Kepler system(0.6);
  StepperOptions options = absoluteOptions(tolerance);
  options.step_min_s = 1e-7;
  options.fixed_step_s = 0.5;
  AdaptiveStepper stepper(makeIntegrator(method), options);
  OdeState state = system.start();
  stepper.advance(system, state, 7);
  stats = stepper.stats();
  EXPECT_EQ(state.t_s, 7);
  const auto exact = system.exact(7);
  return std::hypot(state.r[0] - exact[0], state.r[1] - exact[1]);
}

TEST(StepControl, TradesStepsForAccuracyWithEveryAdaptiveMethod) {
  for (const IntegratorInfo& info : integrators()) {
    if (!info.make()->adaptive()) continue;
    StepperStats loose, tight;
    const double looseError = keplerError(info.name, 1e-5, loose);
    const double tightError = keplerError(info.name, 1e-7, tight);
    EXPECT_LT(tightError, 0.2 * looseError) << info.name;
    EXPECT_GT(2 * tight.steps, 3 * loose.steps) << info.name;
    EXPECT_GT(loose.rejected_inaccurate, 0) << info.name << ": the first step is far too long";
    EXPECT_EQ(tight.forced_steps, 0) << info.name;
    EXPECT_GT(loose.step_max_s, 3 * loose.step_min_s) << info.name << " on an eccentric orbit";
  }
}

TEST(StepControl, FindsTheStepOfEquationTwelveUnderConstantForce) {
  FallingBall ball;
  const double tolerance = 1e-6;
  AdaptiveStepper stepper(makeIntegrator("verlet"), absoluteOptions(tolerance));
  OdeState state{0, {1000}, {0}};
  stepper.advance(ball, state, 1);
  // Δ = g h²/2 = ε, less the safety factor of 0.9
  EXPECT_NEAR(stepper.nextStep_s(), 0.9 * std::sqrt(2 * tolerance / FallingBall::kGravity), 1e-12);
  EXPECT_NEAR(state.r[0], 1000 - 0.5 * FallingBall::kGravity, 1e-9);
}

TEST(StepControl, TakesTheExponentFromTheOrderOfThePair) {
  for (const char* name : {"verlet", "rk2", "implicit-euler", "rosenbrock4"}) {
    Kepler system(0.3);
    const double h_s = 0.05;
    StepperOptions options = absoluteOptions(1e-2);
    options.fixed_step_s = h_s;
    const auto method = makeIntegrator(name);
    method->setSettings(options.integrator);
    OdeState next, state = system.start();
    const double error = method->step(system, state, h_s, next);
    // such that the step is accepted and the next one is twice as long, less the safety factor
    options.tolerance = error * std::pow(2, method->embeddedOrder() + 1);
    AdaptiveStepper stepper(makeIntegrator(name), options);
    stepper.advance(system, state, h_s);
    EXPECT_EQ(stepper.stats().steps, 1) << name;
    EXPECT_NEAR(stepper.nextStep_s(), 0.9 * 2 * h_s, 1e-9) << name;
  }
}

TEST(StepControl, StaysWithinItsBoundsAndReportsForcedSteps) {
  Oscillator system(1e4, 0);
  StepperOptions options = absoluteOptions(1e-9);
  options.step_min_s = 1e-3;
  options.step_max_s = 2e-3;
  AdaptiveStepper stepper(makeIntegrator("verlet"), options);
  OdeState state{0, {1}, {0}};
  stepper.advance(system, state, 0.1);
  EXPECT_GT(stepper.stats().forced_steps, 0);
  EXPECT_GE(stepper.stats().step_min_s, 0.999e-3);
  EXPECT_LE(stepper.stats().step_max_s, 2e-3);
}

TEST(StepControl, TakesEqualStepsWithMethodsOfFixedStep) {
  Oscillator system(1, 0);
  StepperOptions options;
  options.fixed_step_s = 0.01;
  AdaptiveStepper stepper(makeIntegrator("rk4"), options);
  OdeState state{0, {1}, {0}};
  stepper.advance(system, state, 1.005);
  EXPECT_EQ(stepper.stats().steps, 101);
  EXPECT_EQ(state.t_s, 1.005);
  EXPECT_NEAR(state.r[0], std::cos(1.005), 1e-9);
}

TEST(StepControl, StandsStillForTargetsThatAreNotLaterAndFinite) {
  Oscillator system(1, 0);
  AdaptiveStepper stepper(makeIntegrator("verlet"), {});
  OdeState state{2, {1}, {0}};
  for (const double target : {1.0, 2.0, kNan, HUGE_VAL}) stepper.advance(system, state, target);
  EXPECT_EQ(state.t_s, 2);
  EXPECT_EQ(stepper.stats().steps, 0);
}

TEST(StepControl, MovesTimeEvenWhereItIsHuge) {
  Oscillator system(1, 0);
  StepperOptions options;
  options.step_max_s = options.fixed_step_s = options.step_min_s = 1e-6;
  AdaptiveStepper stepper(makeIntegrator("verlet"), options);
  OdeState state{1e12, {1}, {0}};
  stepper.advance(system, state, 1e12 + 1);
  EXPECT_EQ(state.t_s, 1e12 + 1);
  EXPECT_TRUE(allFinite(state));
}

TEST(StepControl, GivesTheSameBitsAgainAfterReset) {
  SpringChain chain(6, 400, 0.5, MatrixKind::symmetric);
  for (const IntegratorInfo& info : integrators()) {
    AdaptiveStepper stepper(info.make(), {});
    OdeState first = chain.start(), second = chain.start();
    stepper.advance(chain, first, 0.2);
    stepper.reset();
    stepper.advance(chain, second, 0.2);
    EXPECT_EQ(first.r, second.r) << info.name;
    EXPECT_EQ(first.v, second.v) << info.name;
  }
}

TEST(StepControl, CanChangeTheMethodWhileRunning) {
  DrivenOscillator system;
  AdaptiveStepper stepper(makeIntegrator("rk2"), absoluteOptions(1e-6));
  OdeState state{0, {0}, {2}};
  double end_s = 0;
  for (int round = 0; round < 2; ++round) {
    for (const IntegratorInfo& info : integrators()) {
      stepper.setIntegrator(info.make());
      stepper.advance(system, state, end_s += 0.05);
      EXPECT_EQ(stepper.integrator().name(), info.name);
      EXPECT_NEAR(state.r[0], DrivenOscillator::exact(end_s), 2e-3) << info.name;
    }
  }
}

TEST(StepControl, CountsWhereTheTimeGoes) {
  SpringChain chain(50, 400, 0.5, MatrixKind::symmetric);
  AdaptiveStepper stepper(makeIntegrator("verlet"), {});
  OdeState state = chain.start();
  stepper.advance(chain, state, 0.5);
  const StepperStats& stats = stepper.stats();
  EXPECT_EQ(stats.cost.force_evaluations, stats.steps + stats.rejected());
  EXPECT_GT(stats.cost.forces_s, 0);
  EXPECT_GT(stats.cost.constraints_s, 0);
  EXPECT_LE(stats.cost.forces_s + stats.cost.constraints_s, stats.total_s);
}

TEST(StepControl, RefusesOptionsOutOfRange) {
  const auto refused = [](auto change) {
    StepperOptions options;
    change(options);
    EXPECT_THROW(AdaptiveStepper(makeIntegrator("verlet"), options), Error);
  };
  refused([](StepperOptions& o) { o.tolerance = 0; });
  refused([](StepperOptions& o) { o.tolerance = kNan; });
  refused([](StepperOptions& o) { o.fixed_step_s = -1; });
  refused([](StepperOptions& o) { o.step_min_s = 0; });
  refused([](StepperOptions& o) { o.step_max_s = 0.5 * o.step_min_s; });
  refused([](StepperOptions& o) { o.correction_limit_m = kNan; });
  refused([](StepperOptions& o) { o.move_limit_m = HUGE_VAL; });
  refused([](StepperOptions& o) { o.repair_damping = 1.5; });
  refused([](StepperOptions& o) { o.integrator.position_scale.threshold = 0; });
}

// ---- contact

struct Fall {
  FallingBall ball;
  AdaptiveStepper stepper;
  OdeState state{0, {1}, {0}};

  Fall(bool tellsDepth, double correction_limit_m)
      : ball(tellsDepth), stepper(makeIntegrator("verlet"), options(correction_limit_m)) {}
  static StepperOptions options(double correction_limit_m) {
    StepperOptions o = absoluteOptions(1);  // accuracy alone would allow steps of 0.4 s
    o.correction_limit_m = correction_limit_m;
    return o;
  }
};

TEST(Contact, StopsTheStepWhereTheBallTouchesTheFloor) {
  const double limit = 1e-6, touch_s = std::sqrt(2 / FallingBall::kGravity);
  const double speed = FallingBall::kGravity * touch_s;
  Fall fall(true, limit);
  fall.stepper.advance(fall.ball, fall.state, touch_s + 2 * limit / speed);
  EXPECT_EQ(fall.state.r[0], 0);
  EXPECT_EQ(fall.state.v[0], 0);
  EXPECT_GE(fall.ball.touchTime_s, touch_s);
  EXPECT_LE(fall.ball.touchTime_s, touch_s + limit / speed);
  EXPECT_LE(fall.stepper.stats().largest_correction_m, limit);
}

TEST(Contact, FindsTheTouchingTimeWithOneRejectedStep) {
  Fall fall(true, 1e-6);
  fall.state.r[0] = 2e-3;
  fall.state.v[0] = -1;
  fall.ball.gravity_m_per_s2 = 0;
  fall.stepper.advance(fall.ball, fall.state, 1);
  EXPECT_EQ(fall.stepper.stats().rejected_contact, 1);
  EXPECT_NEAR(fall.ball.touchTime_s, 2e-3, 1e-6);
  EXPECT_LE(fall.stepper.stats().largest_correction_m, 1e-6);
}

TEST(Contact, SinksInWhereTheSystemCannotTellItsDepth) {
  Fall fall(false, 1e-6);
  fall.stepper.advance(fall.ball, fall.state, 1);
  EXPECT_GT(fall.stepper.stats().largest_correction_m, 1e-3);
  EXPECT_EQ(fall.state.r[0], 0);
}

TEST(Contact, TakesADeepStartWithoutShrinkingSteps) {
  Fall fall(true, 1e-4);
  fall.state.r[0] = -2;
  fall.stepper.advance(fall.ball, fall.state, 0.01);
  EXPECT_GE(fall.state.r[0], 0);
  EXPECT_NEAR(fall.stepper.stats().largest_correction_m, 2, 1e-3);
  EXPECT_LT(fall.stepper.stats().steps + fall.stepper.stats().rejected(), 40);
}

TEST(Contact, RestsOnTheFloorWithABoundedNumberOfSteps) {
  Fall fall(true, 1e-4);
  fall.state.r[0] = 0;
  fall.stepper.advance(fall.ball, fall.state, 1);
  EXPECT_EQ(fall.state.r[0], 0);
  // A step may sink g h²/2 <= limit: h = 4.5 ms.
  EXPECT_LT(fall.stepper.stats().steps, 1000);
}

// ---- repair

// Two oscillators that do not touch; the first one's force is not a number for a while.
class BrokenForce : public SecondOrderSystem {
 public:
  BrokenForce(double from_s, double until_s) : from_s_(from_s), until_s_(until_s) {}
  std::size_t size() const override { return 3; }
  std::span<const double> inverseMass() const override { return inverseMass_; }
  void addPositionForces(double t, std::span<const double> r, std::span<double> f) override {
    f[0] -= 4 * r[0];
    f[1] -= 4 * r[1];
    if (t > from_s_ && t < until_s_) f[0] = f[2] = kNan;
  }

 private:
  double from_s_, until_s_;
  std::vector<double> inverseMass_{1, 1, 0};
};

TEST(Repair, NeverLetsNanOutWithAnyMethod) {
  for (const IntegratorInfo& info : integrators()) {
    BrokenForce system(0.3, 0.35);
    AdaptiveStepper stepper(info.make(), {});
    OdeState state{0, {1, 1, 0}, {0, 0, 2}};
    for (int frame = 1; frame <= 60; ++frame) {
      stepper.advance(system, state, frame / 60.0);
      ASSERT_TRUE(allFinite(state)) << info.name << " at " << state.t_s;
      ASSERT_LE(std::abs(state.r[0]), 1.2) << info.name;
    }
    EXPECT_GT(stepper.stats().repaired_steps, 0) << info.name;
    EXPECT_GT(stepper.stats().repaired_coordinates, 0) << info.name;
    EXPECT_EQ(state.v[2], 2) << info.name << ": driven";
    EXPECT_NEAR(state.r[2], 2, 1e-12) << info.name << ": driven";
  }
}

TEST(Repair, OfForcesThatStayNanCostsABoundedNumberOfSteps) {
  for (const IntegratorInfo& info : integrators()) {
    BrokenForce system(-1, HUGE_VAL);
    AdaptiveStepper stepper(info.make(), {});
    OdeState state{0, {1, 1, 0}, {0.5, 0, 2}};
    stepper.advance(system, state, 10);
    EXPECT_TRUE(allFinite(state)) << info.name;
    EXPECT_LT(stepper.stats().steps + stepper.stats().rejected(), 20000) << info.name;
  }
}

TEST(Repair, TamesARunawayOfAnUnstableStep) {
  Oscillator system(1e9, 0);
  AdaptiveStepper stepper(makeIntegrator("euler"), {});
  OdeState state{0, {1}, {0}};
  stepper.advance(system, state, 0.1);
  EXPECT_TRUE(allFinite(state));
  EXPECT_GT(stepper.stats().rejected_failed, 0);
}

TEST(Repair, MendsAStartThatIsNotFinite) {
  Oscillator system(4, 0.1);
  AdaptiveStepper stepper(makeIntegrator("verlet"), {});
  OdeState state{0, {kNan}, {HUGE_VAL}};
  stepper.advance(system, state, 0.1);
  EXPECT_TRUE(allFinite(state));
  EXPECT_EQ(stepper.stats().repaired_coordinates, 2);
}

TEST(Repair, KeepsTheUnprojectedStepIfAConstraintGivesNan) {
  class BrokenFloor : public FallingBall {
   public:
    double project(double, std::span<double> r, std::span<double>) override { return r[0] = kNan; }
  } system;
  AdaptiveStepper stepper(makeIntegrator("verlet"), {});
  OdeState state{0, {1}, {0}};
  stepper.advance(system, state, 0.1);
  EXPECT_NEAR(state.r[0], 1 - 0.5 * FallingBall::kGravity * 0.01, 1e-9);
  EXPECT_EQ(stepper.stats().repaired_steps, stepper.stats().steps);
}

}  // namespace
}  // namespace fascia
