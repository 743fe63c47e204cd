#include <fascia/math/ode/integrator.h>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

// Symplectic (semi-implicit) Euler: v⁺ = v + h M⁻¹ f(t, r, v), r⁺ = r + h v⁺.
class SymplecticEuler final : public Integrator {
 public:
  std::string_view name() const override { return "symplectic-euler"; }
  int order() const override { return 1; }

  double step(SecondOrderSystem& system, const OdeState& from, double h, OdeState& to) override {
    FASCIA_ASSERT(from.r.size() == system.size() && from.v.size() == system.size(),
                  "the state fits the system");
    FASCIA_ASSERT(h > 0, "time goes on");
    const std::size_t n = system.size();
    const std::span<const double> w = system.inverseMass();
    to.resize(n), force_.resize(n);
    evaluateForces(system, from.t_s, from.r, from.v, force_);
    to.t_s = from.t_s + h;
    for (std::size_t i = 0; i < n; ++i) {
      to.v[i] = w[i] > 0 ? from.v[i] + h * w[i] * force_[i] : from.v[i];
      to.r[i] = from.r[i] + h * to.v[i];
    }
    return 0;
  }

 private:
  std::vector<double> force_;
};

}  // namespace

std::unique_ptr<Integrator> makeSymplecticEuler() {
  return std::make_unique<SymplecticEuler>();
}

}  // namespace fascia
