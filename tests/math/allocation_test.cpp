#include <gtest/gtest.h>

#include <vector>

#include <fascia/base/parallel.h>
#include <fascia/math/ode/adaptive_stepper.h>
#include <fascia/math/supernodal_cholesky.h>

#include "ode_systems.h"
#include "support/count_allocations.h"

namespace fascia {
namespace {

TEST(AdaptiveStepper, AllocatesNothingAfterWarmUpWithExplicitMethods) {
  for (const char* name : {"euler", "symplectic-euler", "verlet", "rk2", "rk4"}) {
    test::SpringChain chain(20, 400, 0.5, MatrixKind::general);
    AdaptiveStepper stepper(makeIntegrator(name), {});
    OdeState state = chain.start();
    stepper.advance(chain, state, 0.1);
    const long before = allocations;
    const auto stepsBefore = stepper.stats().steps;
    stepper.advance(chain, state, 0.3);
    EXPECT_EQ(allocations - before, 0) << name;
    EXPECT_GT(stepper.stats().steps, stepsBefore + 5) << name;
  }
}

TEST(AdaptiveStepper, AllocatesNothingAfterWarmUpInContactAndRepair) {
  test::FallingBall ball;
  StepperOptions options;
  options.correction_limit_m = 1e-4;
  AdaptiveStepper stepper(makeIntegrator("verlet"), options);
  OdeState state{0, {1}, {0}};
  stepper.advance(ball, state, 0.5);  // has touched the floor
  state.r[0] = 1;
  const long before = allocations;
  const auto contactsBefore = stepper.stats().rejected_contact;
  stepper.advance(ball, state, 1.5);
  state.v[0] = HUGE_VAL;
  stepper.advance(ball, state, 1.6);
  EXPECT_EQ(allocations - before, 0);
  EXPECT_GT(stepper.stats().rejected_contact, contactsBefore);
  EXPECT_GT(stepper.stats().repaired_coordinates, 0);
}

TEST(SupernodalCholesky, AllocatesNothingAfterTheFirstSolve) {
  const ThreadLimit limit(1);
  SparseMatrix a(3000, 3000);
  for (int i = 0; i < 3000; ++i) {
    a.insert(i, i) = 5;
    if (i >= 50) a.insert(i, i - 50) = -1;
    if (i % 50 > 0) a.insert(i, i - 1) = -1;
  }
  SupernodalCholesky factor;
  SupernodalCholesky::Scratch scratch;
  ASSERT_TRUE(factor.factorize(a));
  std::vector<float> x(factor.size(), 1), y = x, z = x;
  factor.solve(x, y, z, scratch);
  const long before = allocations;
  factor.solve(x, y, z, scratch);
  factor.solve(x, scratch);
  EXPECT_EQ(allocations, before);
  EXPECT_GT(x[0], 0);
}

}  // namespace
}  // namespace fascia
