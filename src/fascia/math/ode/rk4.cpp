#include <fascia/math/ode/integrator.h>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

// The classical fourth-order Runge–Kutta method on y = (r, v), y' = (v, M⁻¹ f).
class RungeKutta4 final : public Integrator {
 public:
  std::string_view name() const override { return "rk4"; }
  int order() const override { return 4; }

  double step(SecondOrderSystem& system, const OdeState& from, double h, OdeState& to) override {
    FASCIA_ASSERT(from.r.size() == system.size() && from.v.size() == system.size(),
                  "the state fits the system");
    FASCIA_ASSERT(h > 0, "time goes on");
    const std::size_t n = system.size();
    to.resize(n), force_.resize(n), stageR_.resize(n), stageV_.resize(n);
    to.t_s = from.t_s + h;
    std::ranges::copy(from.r, to.r.begin());
    std::ranges::copy(from.v, to.v.begin());
    std::ranges::copy(from.r, stageR_.begin());
    std::ranges::copy(from.v, stageV_.begin());

    constexpr double node[] = {0, 0.5, 0.5, 1};
    constexpr double weight[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    for (int stage = 0; stage < 4; ++stage) {
      evaluateForces(system, from.t_s + node[stage] * h, stageR_, stageV_, force_);
      const double next = stage < 3 ? node[stage + 1] : 0;
      accumulate(system.inverseMass(), from, h * weight[stage], h * next, to);
    }
    return 0;
  }

 private:
  // Adds this stage's slopes to the result and moves the stage to the next node.
  void accumulate(std::span<const double> w, const OdeState& from, double weight, double node,
                  OdeState& to) {
    for (std::size_t i = 0; i < w.size(); ++i) {
      const double velocity = stageV_[i];
      const double acceleration = w[i] > 0 ? w[i] * force_[i] : 0;
      to.r[i] += weight * velocity;
      to.v[i] += weight * acceleration;
      stageR_[i] = from.r[i] + node * velocity;
      stageV_[i] = from.v[i] + node * acceleration;
    }
  }

  std::vector<double> force_, stageR_, stageV_;
};

}  // namespace

std::unique_ptr<Integrator> makeRungeKutta4() {
  return std::make_unique<RungeKutta4>();
}

}  // namespace fascia
