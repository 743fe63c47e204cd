#include <fascia/math/ode/integrator.h>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

// Runge–Kutta 2(1): the midpoint rule with explicit Euler embedded (Numerical Recipes §16.1).
class RungeKutta2 final : public Integrator {
 public:
  std::string_view name() const override { return "rk2"; }
  int order() const override { return 2; }
  int embeddedOrder() const override { return 1; }

  double step(SecondOrderSystem& system, const OdeState& from, double h, OdeState& to) override {
    FASCIA_ASSERT(from.r.size() == system.size() && from.v.size() == system.size(),
                  "the state fits the system");
    FASCIA_ASSERT(h > 0, "time goes on");
    const std::size_t n = system.size();
    const std::span<const double> w = system.inverseMass();
    to.resize(n), force_.resize(n), midR_.resize(n), midV_.resize(n);
    to.t_s = from.t_s + h;

    evaluateForces(system, from.t_s, from.r, from.v, force_);
    for (std::size_t i = 0; i < n; ++i) {
      midR_[i] = from.r[i] + 0.5 * h * from.v[i];
      midV_[i] = w[i] > 0 ? from.v[i] + 0.5 * h * w[i] * force_[i] : from.v[i];
    }
    evaluateForces(system, from.t_s + 0.5 * h, midR_, midV_, force_);
    for (std::size_t i = 0; i < n; ++i) {
      to.r[i] = from.r[i] + h * midV_[i];
      to.v[i] = w[i] > 0 ? from.v[i] + h * w[i] * force_[i] : from.v[i];
    }
    // r_E − r⁺ = h (v − v½)
    return scaledNorm(from.r, settings_.position_scale,
                      [&](std::size_t i) { return h * (midV_[i] - from.v[i]); });
  }

 private:
  std::vector<double> force_, midR_, midV_;
};

}  // namespace

std::unique_ptr<Integrator> makeRungeKutta2() {
  return std::make_unique<RungeKutta2>();
}

}  // namespace fascia
