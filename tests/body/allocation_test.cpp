#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include <fascia/base/parallel.h>

#include "scenes.h"

namespace {
std::atomic<long> allocations{0};
}

// Counts what the whole program allocates.
void* operator new(std::size_t bytes) {
  ++allocations;
  if (void* p = std::malloc(bytes > 0 ? bytes : 1)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

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
