#include <fascia/base/assert.h>
#include <fascia/math/ode/implicit_matrix.h>
#include <fascia/math/ode/integrator.h>

namespace fascia {
namespace {

// Implicit Euler: M (v⁺ − v) = h f(t + h, r + h v⁺, v⁺), r⁺ = r + h v⁺, solved for v⁺ by Newton's
// method. The factorisation is kept over iterations and steps while it converges fast (chord
// method); the first guess takes the last step's acceleration.
class ImplicitEuler final : public Integrator {
 public:
  std::string_view name() const override { return "implicit-euler"; }
  int order() const override { return 1; }
  int embeddedOrder() const override { return 1; }

  double step(SecondOrderSystem& system, const OdeState& from, double h, OdeState& to) override {
    FASCIA_ASSERT(from.r.size() == system.size() && from.v.size() == system.size(),
                  "the state fits the system");
    FASCIA_ASSERT(h > 0, "time goes on");
    const std::size_t n = system.size();
    to.resize(n), force_.resize(n);
    if (acceleration_.size() != n) acceleration_.assign(n, 0.0), matrixStep_s_ = 0;
    to.t_s = from.t_s + h;
    for (std::size_t i = 0; i < n; ++i) to.v[i] = from.v[i] + h * acceleration_[i];
    if (!solve(system, from, h, to)) {
      reset();
      return kStepFailed;
    }
    const std::span<const double> w = system.inverseMass();
    for (std::size_t i = 0; i < n; ++i) acceleration_[i] = w[i] > 0 ? (to.v[i] - from.v[i]) / h : 0;
    // The implicit trapezoidal rule's r + h/2 (v + v⁺) is one order better: its distance is the
    // method's local error.
    return scaledNorm(from.r, settings_.position_scale,
                      [&](std::size_t i) { return 0.5 * h * (to.v[i] - from.v[i]); });
  }

  void reset() override { acceleration_.clear(), matrixStep_s_ = 0; }

 private:
  bool solve(SecondOrderSystem& system, const OdeState& from, double h, OdeState& to) {
    // A chord that shrinks the error less than this per iteration costs more than a new matrix.
    constexpr double kSlowRate = 0.2;
    // A matrix for another step length is off by about twice its relative difference.
    constexpr double kSameStep = 0.05;
    // Newton's method may overshoot now and then; more often, a shorter step is cheaper.
    constexpr int kMaxGrowths = 3;
    int growths = 0;
    double lastChange = 0;
    bool fresh = false;
    for (int iteration = 0; iteration < settings_.max_iterations; ++iteration) {
      for (std::size_t i = 0; i < from.r.size(); ++i) to.r[i] = from.r[i] + h * to.v[i];
      if (std::abs(matrixStep_s_ - h) > kSameStep * h) {
        if (!matrix_.update(system, to.t_s, to.r, to.v, h, h * h)) return false;
        matrixStep_s_ = h, fresh = true;
      }
      const double change = correct(system, from, h, to);
      if (!std::isfinite(change)) {
        if (fresh) return false;
        // An outdated matrix may have thrown the iterate far off: begin again with a new one.
        std::ranges::copy(from.v, to.v.begin());
        matrixStep_s_ = 0, lastChange = 0;
        continue;
      }
      // A matrix much stiffer than the forces are now makes small corrections of large errors: only
      // a new matrix, or a correction that shrank as it should, can tell that there is little left.
      const bool trusted = fresh || change <= kSlowRate * lastChange;
      if (trusted && change <= settings_.velocity_tolerance) return finish(from, h, to);
      if (lastChange > 0 && change > kSlowRate * lastChange) matrixStep_s_ = 0;
      if (lastChange > 0 && change > lastChange && ++growths > kMaxGrowths) return false;
      lastChange = change, fresh = false;
    }
    return false;
  }

  // One Newton correction of v⁺; returns its scaled size.
  double correct(SecondOrderSystem& system, const OdeState& from, double h, OdeState& to) {
    const std::span<const double> w = system.inverseMass();
    evaluateForces(system, to.t_s, to.r, to.v, force_);
    residual_.resize(static_cast<Eigen::Index>(force_.size()));
    for (std::size_t i = 0; i < force_.size(); ++i) {
      residual_[static_cast<Eigen::Index>(i)] =
          w[i] > 0 ? h * force_[i] - (to.v[i] - from.v[i]) / w[i] : 0;
    }
    if (!matrix_.solve(residual_, correction_)) return kStepFailed;
    const auto delta = [&](std::size_t i) { return correction_[static_cast<Eigen::Index>(i)]; };
    for (std::size_t i = 0; i < force_.size(); ++i) {
      if (w[i] > 0) to.v[i] += delta(i);
    }
    return scaledNorm(from.v, settings_.velocity_scale, delta);
  }

  static bool finish(const OdeState& from, double h, OdeState& to) {
    for (std::size_t i = 0; i < from.r.size(); ++i) to.r[i] = from.r[i] + h * to.v[i];
    return true;
  }

  ImplicitMatrix matrix_;
  double matrixStep_s_ = 0;  // the step that matrix_ was built for; 0 = build it anew
  std::vector<double> acceleration_, force_;
  Eigen::VectorXd residual_, correction_;
};

}  // namespace

std::unique_ptr<Integrator> makeImplicitEuler() {
  return std::make_unique<ImplicitEuler>();
}

}  // namespace fascia
