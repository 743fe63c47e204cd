#include <gtest/gtest.h>

#include <limits>

#include <fascia/base/error.h>
#include <fascia/base/hash.h>
#include <fascia/base/parallel.h>
#include <fascia/math/ode/adaptive_stepper.h>
#include <fascia/math/ode/integrators.h>

#include "scenes.h"

namespace fascia {
namespace {

using test::linkEnd;

constexpr BodyScheme kAllSchemes[] = {BodyScheme::explicitEuler, BodyScheme::implicitEuler,
                                      BodyScheme::energyConserving};
constexpr BodyMaterial kSoft{.rigidity_Pa = 5e3, .volume_Pa = 1e4};
constexpr BodyMaterial kSteel{.rigidity_Pa = 1e9, .volume_Pa = 2e9};

void advance(BodyStepper& stepper, double time_s, int steps, OdeState& state) {
  for (int i = 0; i < steps; ++i) stepper.step(time_s / steps, state);
}

double distance(const OdeState& a, const OdeState& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.r.size(); ++i)
    largest = std::max(largest, std::abs(a.r[i] - b.r[i]));
  return largest;
}

double lengthsOf(const BodySystem& system, const OdeState& state) {
  double largest = 0;
  for (std::size_t b = 0; b < system.model().bodyCount(); ++b) {
    const BodyId body(static_cast<std::int64_t>(b));
    const Vec3 along = system.model().point(state.r, {body, linkEnd(1)}) -
                       system.model().point(state.r, {body, linkEnd(-1)});
    largest = std::max(largest, along.norm());
  }
  return largest;
}

TEST(BodyStepper, ConvergesToWhatTheSolverLibraryFinds) {
  OdeState start;
  const auto system = test::makeChain(2, start, kSoft);
  OdeState exact = start;
  StepperOptions fine;
  fine.fixed_step_s = 2e-5;
  AdaptiveStepper library(makeIntegrator("rk4"), fine);
  library.advance(*system, exact, 0.1);
  struct Case {
    BodyScheme scheme;
    double order;
  };
  for (const auto& [scheme, order] : {Case{BodyScheme::explicitEuler, 1},
                                      {BodyScheme::implicitEuler, 1},
                                      {BodyScheme::energyConserving, 2}}) {
    double errors[2];
    for (int half = 0; half < 2; ++half) {
      OdeState state = start;
      BodyStepper stepper(*system, {.scheme = scheme});
      advance(stepper, 0.1, half == 0 ? 200 : 400, state);
      errors[half] = distance(state, exact);
    }
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), order, 0.15) << static_cast<int>(scheme);
    EXPECT_LT(errors[1], 5e-3);
  }
}

TEST(BodyStepper, AgreesWithTheLibrarysImplicitMethods) {
  OdeState start;
  const auto system = test::makeChain(2, start, kSoft);
  OdeState ours = start, theirs = start;
  BodyStepper stepper(*system, {.scheme = BodyScheme::energyConserving});
  advance(stepper, 0.05, 200, ours);
  StepperOptions options;
  options.tolerance = 1e-9, options.fixed_step_s = 1e-4, options.step_max_s = 1e-3;
  AdaptiveStepper library(makeIntegrator("rosenbrock4"), options);
  library.advance(*system, theirs, 0.05);
  EXPECT_LT(distance(ours, theirs), 2e-5);
}

TEST(BodyStepper, KeepsConstraintsToRoundingForAMinute) {
  for (const BodyScheme scheme : {BodyScheme::implicitEuler, BodyScheme::energyConserving}) {
    OdeState state;
    const auto system = test::makeChain(2, state);
    BodyStepper stepper(*system, {.scheme = scheme, .tolerance = 1e-8});
    double drift = 0;
    for (int i = 0; i < 3600; ++i) {
      stepper.step(1.0 / 60, state);
      if (i % 20 == 0) drift = std::max(drift, system->drift_m(state));
    }
    EXPECT_LT(drift, 1e-6 * test::kLinkSize_m.x());
    EXPECT_NEAR(state.t_s, 60, 1e-9);
  }
}

TEST(BodyStepper, KeepsTheEnergyOfAnUndampedPendulum) {
  OdeState state;
  const auto system = test::makeChain(1, state, {.rigidity_Pa = 1e6, .volume_Pa = 2e6});
  const double swing_J = system->model().shape(BodyId(0)).mass_kg() * 9.81 * 0.1;
  const double start = system->energy_J(state);
  BodyStepper stepper(*system, {.scheme = BodyScheme::energyConserving, .tolerance = 1e-12});
  double worst = 0, lowest = HUGE_VAL;
  for (int i = 0; i < 1200; ++i) {
    stepper.step(1.0 / 60, state);
    worst = std::max(worst, std::abs(system->energy_J(state) - start));
    lowest = std::min(lowest, system->potentialEnergy_J(state.r, state.t_s));
  }
  EXPECT_LT(worst, 1e-6 * swing_J);
  EXPECT_LT(lowest, start - 0.8 * swing_J);  // it does swing
  EXPECT_EQ(stepper.stats().unconverged, 0u);
}

TEST(BodyStepper, SwingsWithTheClosedFormsPeriod) {
  // A stiff bar hung at its end: T = 2π √(I/(m g l)) with I = m (L²/3 + w²/12) about the end.
  OdeState state;
  const auto system = test::makeChain(1, state, kSteel);
  const double length = test::kLinkSize_m.x(), width = test::kLinkSize_m.y(), angle = 0.01;
  const double inertia = length * length / 3 + width * width / 12;
  const double period_s = 2 * kPi * std::sqrt(inertia / (9.81 * 0.5 * length)) *
                          (1 + angle * angle / 16);  // of this amplitude
  Transform place;
  place.rotation = Eigen::AngleAxisd(angle - 0.5 * kPi, Vec3::UnitZ()).toRotationMatrix();
  place.translation_m = place.rotation * Vec3(0.5 * length, 0, 0);
  system->model().place(BodyId(0), place, state);
  BodyStepper stepper(*system, {.scheme = BodyScheme::energyConserving});
  const double h = 1.0 / 480;
  const BodyPoint tip{BodyId(0), linkEnd(1)};
  double before = system->model().point(state.r, tip).x(), firstUp = 0, lastUp = 0;
  int crossings = 0;
  for (int i = 0; i < 4000; ++i) {
    stepper.step(h, state);
    const double x = system->model().point(state.r, tip).x();
    if (before < 0 && x >= 0) {
      lastUp = state.t_s - h * x / (x - before);
      if (crossings++ == 0) firstUp = lastUp;
    }
    before = x;
  }
  EXPECT_GT(crossings, 8);
  EXPECT_NEAR((lastUp - firstUp) / (crossings - 1), period_s, 2e-4 * period_s);
}

TEST(BodyStepper, KeepsMomentumInFreeFlight) {
  for (const BodyScheme scheme : kAllSchemes) {
    BodyModel model;
    const BodyShapePtr link = test::makeLink(kSoft);
    model.add(link), model.add(link);
    BodySystem system(std::move(model), {.gravity_m_per_s2 = Vec3::Zero()});
    OdeState state = system.model().restState();
    system.hold(makeAttachment("hinge", {BodyId(0), linkEnd(1)}, {BodyId(1), linkEnd(1)}));
    system.applyImpulse({BodyId(1), linkEnd(-1)}, Vec3(0.1, 0.2, 0.3), state);
    const Vec3 linear = system.model().momentum_Ns(state.v);
    const Vec3 angular = system.model().angularMomentum_Nms(state.r, state.v);
    BodyStepper stepper(system, {.scheme = scheme});
    advance(stepper, 0.2, 400, state);
    EXPECT_LT((system.model().momentum_Ns(state.v) - linear).norm(), 1e-9 * linear.norm());
    // Exact for the first, of second order for the last; implicit Euler slows every turn.
    const double allowed = scheme == BodyScheme::explicitEuler   ? 1e-9
                           : scheme == BodyScheme::implicitEuler ? 5e-2
                                                                 : 1e-3;
    EXPECT_LT((system.model().angularMomentum_Nms(state.r, state.v) - angular).norm(),
              allowed * angular.norm())
        << static_cast<int>(scheme);
  }
}

TEST(BodyStepper, FollowsATrajectory) {
  const auto path = [](double t) {
    return PathPoint{Vec3(0.1 * std::sin(3 * t), 0, 0), Vec3(0.3 * std::cos(3 * t), 0, 0),
                     Vec3(-0.9 * std::sin(3 * t), 0, 0)};
  };
  for (const BodyScheme scheme : kAllSchemes) {
    BodyModel model;
    model.add(test::makeLink({.rigidity_Pa = 1e5, .volume_Pa = 1e5, .drag_per_s = 1}));
    BodySystem system(std::move(model));
    OdeState state = system.model().restState();
    const BodyPoint handle{BodyId(0), Vec3::Zero()};
    system.hold(makeTrajectory("hand", handle, path));
    system.matchVelocities(state);
    BodyStepper stepper(system, {.scheme = scheme});
    advance(stepper, 1, 2000, state);
    EXPECT_LT((system.model().point(state.r, handle) - path(state.t_s).position_m).norm(), 1e-12);
    EXPECT_LT((system.model().point(state.v, handle) - path(state.t_s).velocity_m_per_s).norm(),
              1e-3);
  }
}

TEST(BodyStepper, StaysOnALineAndOnAPlane) {
  for (const BodyScheme scheme : kAllSchemes) {
    BodyModel model;
    model.add(test::makeLink(kSoft));
    BodySystem system(std::move(model));
    OdeState state = system.model().restState();
    const Vec3 along(1, -1, 0), normal(0, 0, 1);
    system.hold(makePointOnLine("rail", {BodyId(0), linkEnd(1)}, linkEnd(1), along));
    system.hold(makePointOnPlane("wall", {BodyId(0), linkEnd(-1)}, linkEnd(-1), normal));
    BodyStepper stepper(system, {.scheme = scheme});
    advance(stepper, 0.3, 600, state);
    const Vec3 slid = system.model().point(state.r, {BodyId(0), linkEnd(1)}) - linkEnd(1);
    EXPECT_GT(slid.norm(), 0.05);
    EXPECT_LT(slid.cross(along).norm(), 1e-12);
    EXPECT_NEAR(system.model().point(state.r, {BodyId(0), linkEnd(-1)}).z(), 0, 1e-12);
  }
}

TEST(BodyStepper, HoldsRodsThatAreNotLinear) {
  for (const BodyScheme scheme : kAllSchemes) {
    OdeState state;
    const auto system = test::makeChain(1, state, kSoft);
    const double length = std::hypot(0.2, 0.15);
    system->hold(makeTether("tether", {BodyId(0), linkEnd(1)}, Vec3(0, 0, 0.15), length));
    const double start = system->energy_J(state);
    BodyStepper stepper(*system, {.scheme = scheme});
    advance(stepper, 0.2, 400, state);
    const Vec3 tip = system->model().point(state.r, {BodyId(0), linkEnd(1)});
    EXPECT_LT(tip.y(), -0.05);  // it fell
    const double allowed = scheme == BodyScheme::explicitEuler ? 1e-5 : 1e-9;
    EXPECT_NEAR((tip - Vec3(0, 0, 0.15)).norm(), length, allowed) << static_cast<int>(scheme);
    if (scheme == BodyScheme::energyConserving) {
      EXPECT_NEAR(system->energy_J(state), start, 1e-7);
    }
  }
}

TEST(BodyStepper, SoftConstraintsAreSprings) {
  // A weight on a spring sinks by m g/k and swings about that with ω = √(k/m).
  BodyModel model;
  model.add(test::makeLink(kSteel));
  const double mass = model.shape(BodyId(0)).mass_kg(), k = 40;
  BodySystem system(std::move(model));
  OdeState state = system.model().restState();
  const BodyPoint center{BodyId(0), Vec3::Zero()};
  system.pull({makeNail("spring", center, Vec3::Zero()), k, 0});
  const double start = system.energy_J(state), omega = std::sqrt(k / mass);
  BodyStepper stepper(system, {.scheme = BodyScheme::energyConserving});
  double error = 0;
  for (int i = 0; i < 400; ++i) {
    stepper.step(1e-3, state);
    const double exact = mass * 9.81 / k * (std::cos(omega * state.t_s) - 1);
    error = std::max(error, std::abs(system.model().point(state.r, center).y() - exact));
  }
  EXPECT_LT(error, 1e-4 * mass * 9.81 / k);
  EXPECT_NEAR(system.energy_J(state), start, 1e-9);
}

TEST(BodyStepper, IsStableFromJellyToSteel) {
  for (const double rigidity_Pa : {1e3, 1e6, 1e9}) {
    OdeState state;
    const auto system =
        test::makeChain(4, state, {.rigidity_Pa = rigidity_Pa, .volume_Pa = rigidity_Pa});
    BodyStepper stepper(*system, {.scheme = BodyScheme::implicitEuler, .tolerance = 1e-8});
    advance(stepper, 3, 180, state);
    EXPECT_EQ(stepper.stats().stopped, 0u);
    const double stretched = rigidity_Pa < 1e4 ? 3 : 1.05;
    EXPECT_LT(lengthsOf(*system, state), stretched * test::kLinkSize_m.x()) << rigidity_Pa;
    EXPECT_LT(system->energy_J(state), 0);
  }
}

TEST(BodyStepper, IsStableForMassesTenThousandTimesApart) {
  for (const bool heavyLast : {false, true}) {
    BodyModel model;
    const BodyShapePtr light = test::makeLink(kSteel, 10), heavy = test::makeLink(kSteel, 1e5);
    model.add(heavyLast ? light : heavy), model.add(heavyLast ? heavy : light);
    BodySystem system(std::move(model));
    OdeState state = system.model().restState();
    system.hold(makeNail("nail", {BodyId(0), linkEnd(-1)}, linkEnd(-1)));
    system.hold(makeAttachment("hinge", {BodyId(0), linkEnd(1)}, {BodyId(1), linkEnd(1)}));
    BodyStepper stepper(system, {.tolerance = 1e-8});
    advance(stepper, 3, 180, state);
    EXPECT_EQ(stepper.stats().stopped, 0u);
    EXPECT_LT(lengthsOf(system, state), 1.01 * test::kLinkSize_m.x());
    EXPECT_LT(system.drift_m(state), 1e-9);
  }
}

TEST(BodyStepper, GivesTheSameBitsOnAnyNumberOfThreads) {
  for (const BodyScheme scheme : kAllSchemes) {
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2, 5}) {
      const ThreadLimit limit(threads);
      OdeState state;
      const auto system = test::makeChain(200, state, kSoft);
      BodyStepper stepper(*system, {.scheme = scheme, .max_iterations = 3});
      advance(stepper, 0.01, 10, state);
      StateHash hash;
      for (const double x : state.r) hash.add(x);
      for (const double x : state.v) hash.add(x);
      hashes.push_back(hash.value());
    }
    EXPECT_EQ(hashes[0], hashes[1]);
    EXPECT_EQ(hashes[0], hashes[2]);
  }
}

TEST(BodyStepper, StandsStillRatherThanExplode) {
  OdeState state;
  const auto system = test::makeChain(2, state);
  system->addPointForce({BodyId(0), linkEnd(1)},
                        Vec3(0, std::numeric_limits<double>::quiet_NaN(), 0));
  for (const BodyScheme scheme : kAllSchemes) {
    OdeState trial = state;
    BodyStepper stepper(*system, {.scheme = scheme});
    stepper.step(0.01, trial);
    EXPECT_GT(stepper.stats().stopped, 0u);
    for (const double x : trial.r) EXPECT_TRUE(std::isfinite(x));
  }
  system->clearPointForces();
  BodyStepper stepper(*system);
  stepper.step(0.01, state);
  EXPECT_EQ(stepper.stats().stopped, 0u);
}

TEST(BodySystem, FeedbackTakesDriftAwayWithoutFeedingEnergyIn) {
  OdeState state;
  const auto system =
      test::makeChain(2, state, {.rigidity_Pa = 5e3, .volume_Pa = 1e4}, {Vec3::Zero(), 0.05});
  for (std::size_t i = 0; i < 12; ++i) state.r[i] += 0.002;
  const double start = system->drift_m(state);
  // AdaptiveStepper would project; integrate with the method alone.
  const auto rk4 = makeIntegrator("rk4");
  OdeState next = state;
  double after = 0;
  for (int i = 0; i < 5000; ++i) {
    rk4->step(*system, state, 1e-4, next);
    std::swap(state, next);
    if (i == 999) after = system->drift_m(state);
  }
  // Critically damped: (1 + t/τ) exp(−t/τ) of the start at t = 0.1 s.
  EXPECT_NEAR(after / start, 3 * std::exp(-2), 2e-3);
  EXPECT_LT(system->drift_m(state), 1e-3 * start);
  const double settled = system->energy_J(state);
  for (int i = 0; i < 2000; ++i) {
    rk4->step(*system, state, 1e-4, next);
    std::swap(state, next);
  }
  EXPECT_NEAR(system->energy_J(state), settled, 1e-5 * settled);
}

}  // namespace
}  // namespace fascia
