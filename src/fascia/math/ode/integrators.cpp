#include <fascia/math/ode/integrators.h>

#include <string>

#include <fascia/base/error.h>

// One line per method: X(name, maker, description); the maker is defined in the method's own file.
#define FASCIA_INTEGRATORS(X)                                                                    \
  X("euler", makeEuler, "explicit Euler: order 1, fixed step, the simplest and least stable")    \
  X("symplectic-euler", makeSymplecticEuler, "order 1, fixed step, keeps energy bounded")        \
  X("implicit-euler", makeImplicitEuler, "order 1, adaptive, stable for any step, damps motion") \
  X("verlet", makeVerlet, "leapfrog-Verlet 2(1): order 2, adaptive, one force per step")         \
  X("rk2", makeRungeKutta2, "Runge-Kutta 2(1), midpoint: order 2, adaptive")                     \
  X("rk4", makeRungeKutta4, "classical Runge-Kutta: order 4, fixed step")                        \
  X("rosenbrock4", makeRosenbrock4,                                                              \
    "Kaps-Rentrop 4(3): order 4, adaptive, implicit, for stiff skins")

namespace fascia {

#define FASCIA_DECLARE(name, make, description) std::unique_ptr<Integrator> make();
FASCIA_INTEGRATORS(FASCIA_DECLARE)
#undef FASCIA_DECLARE

std::span<const IntegratorInfo> integrators() {
#define FASCIA_ENTRY(name, make, description) {name, description, make},
  static constexpr IntegratorInfo entries[] = {FASCIA_INTEGRATORS(FASCIA_ENTRY)};
#undef FASCIA_ENTRY
  return entries;
}

std::unique_ptr<Integrator> makeIntegrator(std::string_view name) {
  std::string names;
  for (const IntegratorInfo& info : integrators()) {
    if (info.name == name) return info.make();
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  }
  throw Error("unknown integrator \"" + std::string(name) + "\", expected one of " + names);
}

}  // namespace fascia
