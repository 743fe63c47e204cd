#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <fascia/base/error.h>
#include <fascia/math/finite_difference.h>
#include <fascia/math/ode/stability.h>

#include "ode_systems.h"

namespace fascia {
namespace {

using namespace test;
using testing::HasSubstr;

std::unique_ptr<Integrator> make(std::string_view name) {
  auto method = makeIntegrator(name);
  method->setSettings(tightSettings());
  return method;
}

TEST(Integrators, IncludeTheSixOfThePaper) {
  for (const char* name : {"euler", "implicit-euler", "verlet", "rk2", "rk4", "rosenbrock4"})
    EXPECT_NO_THROW(makeIntegrator(name)) << name;
}

TEST(Integrators, ListTheNamesWhenAskedForAnUnknownOne) {
  try {
    makeIntegrator("verlot");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("verlot"));
    for (const IntegratorInfo& info : integrators())
      EXPECT_THAT(error.what(), HasSubstr(std::string(info.name)));
  }
}

// The limits of the textbooks (Hairer & Wanner 1996, §IV.2).
TEST(LongestStableStep, IsThatOfTheStabilityFunction) {
  const double omega = 800, gamma = 12;
  const auto of = [&](const char* name, double damping) {
    return longestStableStep_s(*make(name), omega, damping);
  };
  EXPECT_EQ(of("euler", 0), 0);
  EXPECT_NEAR(of("euler", gamma), gamma / (omega * omega), 1e-3 * gamma / (omega * omega));
  const double midpoint = std::cbrt(4 * gamma / std::pow(omega, 4));
  EXPECT_NEAR(of("rk2", gamma), midpoint, 0.03 * midpoint);
  EXPECT_NEAR(of("rk4", 0), std::sqrt(8.0) / omega, 1e-3 / omega);
  for (const char* name : {"verlet", "symplectic-euler"})
    EXPECT_NEAR(of(name, 0), 2 / omega, 1e-3 / omega) << name;
  for (const char* name : {"implicit-euler", "rosenbrock4"}) EXPECT_EQ(of(name, 0), 1) << name;
}

TEST(LongestStableStep, LeavesSettingsAsTheyWere) {
  const auto method = make("verlet");
  const double before = method->settings().velocity_tolerance;
  longestStableStep_s(*method, 100, 1);
  EXPECT_EQ(method->settings().velocity_tolerance, before);
}

TEST(Leapfrog, IsReversibleInTime) {
  Kepler system(0.5);
  const OdeState start = system.start();
  const auto method = make("verlet");
  OdeState turned = runSteps(*method, system, start, 5, 200);
  EXPECT_GT(std::abs(turned.r[0] - start.r[0]), 0.1);
  for (double& v : turned.v) v = -v;
  const OdeState back = runSteps(*method, system, turned, 5, 200);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(back.r[i], start.r[i], 1e-11);
}

TEST(Leapfrog, KeepsEnergyBoundedOverAThousandPeriods) {
  Oscillator system(1, 0);
  const OdeState start{0, {1}, {0}};
  const double h = 0.1;
  for (const char* name : {"verlet", "symplectic-euler"}) {
    const auto method = make(name);
    OdeState state = start, next;
    double largest = 0;
    for (int i = 0; i < 62832; ++i) {
      method->step(system, state, h, next);
      std::swap(state, next);
      largest = std::max(largest, std::abs(system.energy(state) / system.energy(start) - 1));
    }
    EXPECT_LT(largest, 0.06) << name;
    EXPECT_GT(largest, 1e-4) << name;
  }
}

TEST(Leapfrog, EvaluatesPositionForcesOncePerStepAndIteratesVelocityForcesOnly) {
  Oscillator system(4, 2);
  const auto method = make("verlet");
  runSteps(*method, system, {0, {1}, {0}}, 1, 10);
  EXPECT_EQ(system.positionCalls, 10);
  EXPECT_GT(system.velocityCalls, 20);
}

// Solves for the new velocity itself.
class SolvedOscillator : public Oscillator {
 public:
  using Oscillator::Oscillator;
  bool midpointKick(double t, std::span<const double> r, std::span<const double> v, double h,
                    std::span<double> out) override {
    double force = 0, drag = 0;
    const double one = 1;
    addPositionForces(t, r, {&force, 1});
    Oscillator::addVelocityForces(t, r, {&one, 1}, {&drag, 1});
    velocityCalls = 0;
    const double a = 0.5 * h * inverseMass()[0];
    out[0] = (v[0] * (1 + a * drag) + 2 * a * force) / (1 - a * drag);
    return true;
  }
};

TEST(Leapfrog, AsksNoVelocityForcesOfASystemThatSolvesForTheVelocity) {
  Oscillator iterated(4, 2);
  SolvedOscillator solved(4, 2);
  const OdeState expected = runSteps(*make("verlet"), iterated, {0, {1}, {0}}, 1, 10);
  const OdeState found = runSteps(*make("verlet"), solved, {0, {1}, {0}}, 1, 10);
  EXPECT_NEAR(found.r[0], expected.r[0], 1e-5);
  EXPECT_NEAR(found.v[0], expected.v[0], 1e-5);
  EXPECT_EQ(solved.positionCalls, 10);
  EXPECT_EQ(solved.velocityCalls, 0);
}

TEST(FiniteCheck, KnowsInfinitiesAndNotANumber) {
  using Limits = std::numeric_limits<double>;
  FiniteCheck sound;
  for (const double x : {0.0, -0.0, 1e-310, -1.5, Limits::max(), Limits::lowest()}) sound.add(x);
  EXPECT_TRUE(sound.allFinite());
  for (const double x :
       {Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN(), -Limits::signaling_NaN()}) {
    FiniteCheck check = sound;
    check.add(x);
    check.add(1);
    EXPECT_FALSE(check.allFinite());
  }
}

TEST(Leapfrog, SolvesTheMidpointVelocityEquation) {
  const double k = 4, c = 2, h = 0.1;
  Oscillator system(k, c);
  OdeState next;
  make("verlet")->step(system, {0, {1}, {0.3}}, h, next);
  // v⁺ = v + h (−k r½ − c (v + v⁺)/2), solved by hand
  const double midR = 1 + 0.5 * h * 0.3;
  const double v = (0.3 * (1 - 0.5 * h * c) - h * k * midR) / (1 + 0.5 * h * c);
  EXPECT_NEAR(next.v[0], v, 1e-13);
  EXPECT_NEAR(next.r[0], midR + 0.5 * h * v, 1e-14);
}

TEST(Leapfrog, FailsWhereTheVelocityIterationDiverges) {
  Oscillator system(1, 50);  // h c / 2m = 2.5 > 1
  OdeState next;
  EXPECT_EQ(make("verlet")->step(system, {0, {1}, {1}}, 0.1, next), kStepFailed);
}

TEST(EmbeddedEuler, IsWhatTheSecondOrderPairsCompareWith) {
  Kepler system(0.4);
  const OdeState start{0, {0.5, 0.4}, {-0.7, 0.9}};
  const double h = 0.05;
  for (const char* name : {"verlet", "rk2"}) {
    OdeState next;
    auto method = make(name);
    IntegratorSettings settings = tightSettings();
    settings.position_scale = {.threshold = 0.45, .relative = true};
    method->setSettings(settings);
    const double error = method->step(system, start, h, next);
    double expected = 0;
    const double scale[] = {1 / 0.5, 1 / 0.45};
    for (int i = 0; i < 2; ++i) {
      const double euler = start.r[i] + h * start.v[i];
      expected = std::max(expected, std::abs(euler - next.r[i]) * scale[i]);
    }
    EXPECT_NEAR(error, expected, 1e-15) << name;
    EXPECT_GT(error, 1e-4) << name;
  }
}

class ImplicitIntegrator : public testing::TestWithParam<const char*> {};

TEST_P(ImplicitIntegrator, StaysStableFarBeyondTheExplicitLimit) {
  for (const double omega : {1e2, 1e4, 1e6}) {
    Oscillator system(omega * omega, 0.1 * omega);
    const auto method = make(GetParam());
    const OdeState start{0, {1}, {0}};
    const OdeState end = runSteps(*method, system, start, 10, 100);
    EXPECT_LT(system.energy(end), 0.01 * system.energy(start)) << "h omega = " << 0.1 * omega;
  }
  Oscillator system(1e8, 0);
  const OdeState exploded = runSteps(*make("rk4"), system, {0, {1}, {0}}, 10, 100);
  EXPECT_FALSE(std::abs(exploded.r[0]) < 1e10) << "the problem is not stiff";
}

TEST_P(ImplicitIntegrator, IsTheSameWithASymmetricAndAGeneralFactorisation) {
  SpringChain symmetric(12, 800, 0.5, MatrixKind::symmetric);
  SpringChain general(12, 800, 0.5, MatrixKind::general);
  const OdeState a = runSteps(*make(GetParam()), symmetric, symmetric.start(), 0.5, 50);
  const OdeState b = runSteps(*make(GetParam()), general, general.start(), 0.5, 50);
  for (std::size_t i = 0; i < a.r.size(); ++i) EXPECT_NEAR(a.r[i], b.r[i], 1e-9);
  EXPECT_LT(a.r.back(), -0.1) << "the chain did not fall";
}

TEST_P(ImplicitIntegrator, FollowsTheFineExplicitSolutionOfAChain) {
  SpringChain chain(6, 400, 0.5, MatrixKind::symmetric);
  const OdeState fine = runSteps(*make("rk4"), chain, chain.start(), 0.5, 4000);
  const auto method = make(GetParam());
  const int steps = method->order() == 1 ? 8000 : 200;
  const OdeState end = runSteps(*method, chain, chain.start(), 0.5, steps);
  for (std::size_t i = 0; i < fine.r.size(); ++i) EXPECT_NEAR(end.r[i], fine.r[i], 2e-3);
}

TEST_P(ImplicitIntegrator, FailsInsteadOfReturningNan) {
  Oscillator system(std::numeric_limits<double>::quiet_NaN(), 0);
  OdeState next;
  EXPECT_EQ(make(GetParam())->step(system, {0, {1}, {0}}, 0.1, next), kStepFailed);
}

// A very stiff spring that breaks at half a second, under a constant force of 1 N.
class BreakingSpring : public Oscillator {
 public:
  BreakingSpring() : Oscillator(1e10, 0) {}
  bool forcesDependOnTime() const override { return true; }
  void addPositionForces(double t, std::span<const double> r, std::span<double> f) override {
    if (t < 0.5) Oscillator::addPositionForces(t, r, f);
    f[0] += 1;
  }
};

// The kept factorisation must not hide it.
TEST(ImplicitEuler, NoticesThatAStiffForceHasGone) {
  BreakingSpring system;
  const auto method = make("implicit-euler");
  method->setSettings({.velocity_tolerance = 1e-3});
  const OdeState end = runSteps(*method, system, {0, {0}, {0}}, 1, 100);
  EXPECT_NEAR(end.v[0], 0.5, 0.02);  // free since half a second
}

INSTANTIATE_TEST_SUITE_P(Ode, ImplicitIntegrator, testing::Values("implicit-euler", "rosenbrock4"),
                         [](const auto& which) {
                           std::string name(which.param);
                           std::erase(name, '-');
                           return name;
                         });

TEST(ForceJacobian, ByDefaultEqualsTheAnalyticOne) {
  SpringChain chain(5, 300, 0.7, MatrixKind::symmetric);
  const OdeState s = runSteps(*make("rk4"), chain, chain.start(), 0.3, 300);
  SparseMatrix dfdr, dfdv, numericDfdr, numericDfdv;
  chain.forceJacobian(0, s.r, s.v, dfdr, dfdv);
  chain.SecondOrderSystem::forceJacobian(0, s.r, s.v, numericDfdr, numericDfdv);
  EXPECT_LT(derivativeMismatch(Eigen::MatrixXd(dfdr), Eigen::MatrixXd(numericDfdr)), 1e-8);
  EXPECT_LT(derivativeMismatch(Eigen::MatrixXd(dfdv), Eigen::MatrixXd(numericDfdv)), 1e-8);
}

}  // namespace
}  // namespace fascia
