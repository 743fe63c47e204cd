#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "ode_systems.h"

namespace fascia {
namespace {

using namespace test;

class EveryIntegrator : public testing::TestWithParam<std::string> {
 protected:
  EveryIntegrator() { method_->setSettings(tightSettings()); }

  // Observed order between n and 2n steps against the exact r[0] at the end.
  double observedOrder(SecondOrderSystem& system, const OdeState& start, double end_s, int n,
                       double exact) {
    method_->reset();
    const double coarse = std::abs(runSteps(*method_, system, start, end_s, n).r[0] - exact);
    method_->reset();
    const double fine = std::abs(runSteps(*method_, system, start, end_s, 2 * n).r[0] - exact);
    EXPECT_GT(fine, 1e-13) << "too exact to see an order";
    return std::log2(coarse / fine);
  }

  std::unique_ptr<Integrator> method_ = makeIntegrator(GetParam());
};

class AdaptiveIntegrator : public EveryIntegrator {};

// Fewer steps for high orders: their error has to stay above round-off, that of low orders small
// enough to be in the asymptotic range.
int stepsFor(int order) {
  return order == 1 ? 4000 : order == 2 ? 400 : 80;
}

TEST_P(EveryIntegrator, ConvergesWithItsOrderOnTheHarmonicOscillator) {
  Oscillator system(4, 0);
  const double end_s = 1.1;
  const double order =
      observedOrder(system, {0, {1}, {0}}, end_s, stepsFor(method_->order()), system.exact(end_s));
  EXPECT_NEAR(order, method_->order(), 0.1);
}

TEST_P(EveryIntegrator, ConvergesWithItsOrderUnderVelocityForces) {
  Oscillator system(4, 0.8, 1.3);
  const double end_s = 1.7;
  const double order =
      observedOrder(system, {0, {1}, {0}}, end_s, stepsFor(method_->order()), system.exact(end_s));
  EXPECT_NEAR(order, method_->order(), 0.1);
}

TEST_P(EveryIntegrator, ConvergesWithItsOrderUnderForcesThatChangeWithTime) {
  DrivenOscillator system;
  const double end_s = 1.3;
  const double order = observedOrder(system, {0, {0}, {2}}, end_s, stepsFor(method_->order()),
                                     DrivenOscillator::exact(end_s));
  EXPECT_NEAR(order, method_->order(), 0.15);
}

TEST_P(EveryIntegrator, ConvergesWithItsOrderOnAnEllipticOrbit) {
  Kepler system(0.3);
  const double end_s = 2;
  const double order = observedOrder(system, system.start(), end_s, stepsFor(method_->order()),
                                     system.exact(end_s)[0]);
  EXPECT_NEAR(order, method_->order(), 0.2);
}

TEST_P(EveryIntegrator, ConvergesWithItsOrderWhenTowedByADrivenCoordinate) {
  TowedMass system;
  const double end_s = 1.7;
  const double order = observedOrder(system, TowedMass::start(), end_s, stepsFor(method_->order()),
                                     TowedMass::exact(end_s));
  EXPECT_NEAR(order, method_->order(), 0.1);
}

TEST_P(EveryIntegrator, KeepsTheVelocityOfDrivenCoordinates) {
  TowedMass system;
  const OdeState end = runSteps(*method_, system, TowedMass::start(), 1, 64);
  EXPECT_DOUBLE_EQ(end.v[1], TowedMass::kSpeed);
  EXPECT_NEAR(end.r[1], TowedMass::kSpeed, 1e-14);
}

TEST_P(AdaptiveIntegrator, EstimatesAnErrorOfTheEmbeddedOrder) {
  Kepler system(0.3);
  OdeState start = system.start(), next;
  start = runSteps(*method_, system, start, 1, 200);  // away from the symmetry of the start
  method_->reset();
  const double coarse = method_->step(system, start, 0.04, next);
  method_->reset();
  const double fine = method_->step(system, start, 0.02, next);
  EXPECT_GT(fine, 1e-12);
  EXPECT_NEAR(std::log2(coarse / fine), method_->embeddedOrder() + 1, 0.25);
}

TEST_P(EveryIntegrator, IsNamedInTheRegistryAsItNamesItself) {
  EXPECT_EQ(method_->name(), GetParam());
}

std::vector<std::string> names(bool adaptiveOnly) {
  std::vector<std::string> result;
  for (const IntegratorInfo& info : integrators()) {
    if (!adaptiveOnly || info.make()->adaptive()) result.emplace_back(info.name);
  }
  return result;
}

std::string testName(const testing::TestParamInfo<std::string>& which) {
  std::string name = which.param;
  std::erase(name, '-');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Ode, EveryIntegrator, testing::ValuesIn(names(false)), testName);
INSTANTIATE_TEST_SUITE_P(Ode, AdaptiveIntegrator, testing::ValuesIn(names(true)), testName);

}  // namespace
}  // namespace fascia
