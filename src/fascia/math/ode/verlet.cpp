#include <fascia/math/ode/integrator.h>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

// Leapfrog-Verlet 2(1) with velocity-dependent forces (Turner & Gobbetti 1998, eqs. 7a–7h, after
// Mathiowetz). Their (7f) prints h/2 · a, which is of first order only; it has to be h · a. Systems
// that can solve (7c)–(7g) for the new velocity are asked to; others are iterated on.
class Verlet final : public Integrator {
 public:
  std::string_view name() const override { return "verlet"; }
  int order() const override { return 2; }
  int embeddedOrder() const override { return 1; }

  double step(SecondOrderSystem& system, const OdeState& from, double h, OdeState& to) override {
    FASCIA_ASSERT(from.r.size() == system.size() && from.v.size() == system.size(),
                  "the state fits the system");
    FASCIA_ASSERT(h > 0, "time goes on");
    const std::size_t n = system.size();
    to.resize(n);
    to.t_s = from.t_s + h;
    for (std::size_t i = 0; i < n; ++i) to.r[i] = from.r[i] + 0.5 * h * from.v[i];
    if (!system.midpointKick(from.t_s + 0.5 * h, to.r, from.v, h, to.v) &&
        !kickByForces(system, from, h, to))
      return kStepFailed;
    const double half = 0.5 * h;
    const double *v = from.v.data(), *vAfter = to.v.data();
    double* r = to.r.data();
    // Embedded Euler r + h v (eq. 9) differs from r⁺ by h/2 (v − v⁺).
    return scaledNorm(from.r, settings_.position_scale, [=](std::size_t i) {
      r[i] += half * vAfter[i];
      return half * (vAfter[i] - v[i]);
    });
  }

 private:
  bool kickByForces(SecondOrderSystem& system, const OdeState& from, double h, OdeState& to) {
    positionForce_.assign(system.size(), 0.0);
    system.addPositionForces(from.t_s + 0.5 * h, to.r, positionForce_);
    if (system.hasVelocityForces()) return iterateVelocity(system, from, h, to);
    kick(system.inverseMass(), positionForce_, from, h, to);
    return true;
  }

  // v⁺ = v + h M⁻¹ f
  static void kick(std::span<const double> w, std::span<const double> force, const OdeState& from,
                   double h, OdeState& to) {
    for (std::size_t i = 0; i < force.size(); ++i)
      to.v[i] = w[i] > 0 ? from.v[i] + h * w[i] * force[i] : from.v[i];
  }

  // Fixed point of (7c)–(7g). r½ stays, so only velocity forces are computed anew.
  bool iterateVelocity(SecondOrderSystem& system, const OdeState& from, double h, OdeState& to) {
    const std::size_t n = system.size();
    force_.resize(n), midVelocity_.resize(n), oldVelocity_.resize(n);
    std::ranges::copy(from.v, to.v.begin());
    for (int iteration = 0; iteration < settings_.max_iterations; ++iteration) {
      for (std::size_t i = 0; i < n; ++i) midVelocity_[i] = 0.5 * (to.v[i] + from.v[i]);
      std::ranges::copy(positionForce_, force_.begin());
      system.addVelocityForces(from.t_s + 0.5 * h, to.r, midVelocity_, force_);
      oldVelocity_.swap(to.v);
      kick(system.inverseMass(), force_, from, h, to);
      const double change = scaledNorm(from.v, settings_.velocity_scale,
                                       [&](std::size_t i) { return to.v[i] - oldVelocity_[i]; });
      // A NaN ends it too: the caller sees it in the result, and where it is.
      if (!(change > settings_.velocity_tolerance)) return true;
    }
    return false;
  }

  std::vector<double> positionForce_, force_, midVelocity_, oldVelocity_;
};

}  // namespace

std::unique_ptr<Integrator> makeVerlet() {
  return std::make_unique<Verlet>();
}

}  // namespace fascia
