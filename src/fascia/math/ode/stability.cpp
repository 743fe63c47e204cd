#include <fascia/math/ode/stability.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

// One mass of 1 kg.
class Swing final : public SecondOrderSystem {
 public:
  Swing(double frequency_per_s, double damping_per_s)
      : stiffness_(frequency_per_s * frequency_per_s), damping_(damping_per_s) {}

  std::size_t size() const override { return 1; }
  std::span<const double> inverseMass() const override { return inverseMass_; }
  bool hasVelocityForces() const override { return damping_ > 0; }
  void addPositionForces(double, std::span<const double> r, std::span<double> f) override {
    f[0] -= stiffness_ * r[0];
  }
  void addVelocityForces(double, std::span<const double>, std::span<const double> v,
                         std::span<double> f) override {
    f[0] -= damping_ * v[0];
  }
  void forceJacobian(double, std::span<const double>, std::span<const double>, SparseMatrix& dfdr,
                     SparseMatrix& dfdv) override {
    dfdr.resize(1, 1), dfdv.resize(1, 1);
    dfdr.coeffRef(0, 0) = -stiffness_;
    dfdv.coeffRef(0, 0) = -damping_;
  }

 private:
  double stiffness_, damping_;
  std::vector<double> inverseMass_{1};
};

// The larger eigenvalue of what one step makes of a state. Positions are measured in units of 1/ω,
// so that a swing is as large in r as in v.
double growth(Integrator& integrator, Swing& swing, double frequency_per_s, double h_s) {
  double m[2][2];
  for (int column = 0; column < 2; ++column) {
    OdeState from, to;
    from.r = {column == 0 ? 1 / frequency_per_s : 0.0}, from.v = {column == 1 ? 1.0 : 0.0};
    integrator.reset();
    if (integrator.step(swing, from, h_s, to) == kStepFailed) return HUGE_VAL;
    m[0][column] = to.r[0] * frequency_per_s, m[1][column] = to.v[0];
  }
  const double half = 0.5 * (m[0][0] + m[1][1]);
  const double determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
  const std::complex<double> root = std::sqrt(std::complex<double>(half * half - determinant));
  return std::max(std::abs(half + root), std::abs(half - root));
}

}  // namespace

double longestStableStep_s(Integrator& integrator, double frequency_per_s, double damping_per_s) {
  FASCIA_ASSERT(frequency_per_s > 0 && damping_per_s >= 0, "an oscillation");
  constexpr double kRounding = 1e-9, kLongest_s = 1;
  const IntegratorSettings settings = integrator.settings();
  IntegratorSettings exact;
  exact.velocity_tolerance = 1e-13;
  exact.max_iterations = 1000;
  integrator.setSettings(exact);
  const auto found = [&](double h_s) {
    integrator.setSettings(settings);
    integrator.reset();
    return h_s;
  };
  Swing swing(frequency_per_s, damping_per_s);
  const auto stable = [&](double h_s) {
    return growth(integrator, swing, frequency_per_s, h_s) <= 1 + kRounding;
  };
  // Up from where every consistent method is as good as exact, then between the last two.
  double low = 1e-4 / frequency_per_s, high = low;
  if (!stable(low)) return found(0);
  while (stable(high)) {
    if (high >= kLongest_s) return found(kLongest_s);
    low = high;
    high = std::min(1.1 * high, kLongest_s);
  }
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (stable(middle) ? low : high) = middle;
  }
  return found(low);
}

}  // namespace fascia
