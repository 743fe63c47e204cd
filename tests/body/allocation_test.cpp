#include <gtest/gtest.h>

#include <fascia/base/parallel.h>

#include "scenes.h"
#include "support/count_allocations.h"

namespace fascia {
namespace {

TEST(BodyStepper, AllocatesOnlyWhenConstraintsChange) {
  const ThreadLimit one(1);
  for (const BodyScheme scheme :
       {BodyScheme::explicitEuler, BodyScheme::implicitEuler, BodyScheme::energyConserving}) {
    OdeState state;
    const auto system = test::makeChain(
        4, state, {.rigidity_Pa = 5e3, .relaxation_s = 1e-3, .power_damping_s_per_J = 0.01});
    system->hold(makeNail("again", {BodyId(0), test::linkEnd(-1)}, Vec3::Zero()));
    system->hold(makeTether("tether", {BodyId(2), test::linkEnd(1)}, Vec3(0.6, 0.3, 0), 0.3));
    system->pull({makeNail("spring", {BodyId(3), test::linkEnd(1)}, Vec3(0.8, 0, 0.1)), 50, 1});
    BodyStepper stepper(*system, {.scheme = scheme});
    for (int i = 0; i < 3; ++i) stepper.step(1e-3, state);
    const long before = allocations;
    for (int i = 0; i < 20; ++i) stepper.step(1e-3, state);
    EXPECT_EQ(allocations - before, 0) << static_cast<int>(scheme);
    system->hold(makeNail("end", {BodyId(3), test::linkEnd(1)},
                          system->model().point(state.r, {BodyId(3), test::linkEnd(1)})));
    stepper.step(1e-3, state);
    EXPECT_GT(allocations - before, 0);
  }
}

}  // namespace
}  // namespace fascia
