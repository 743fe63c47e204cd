#include <array>

#include <fascia/base/assert.h>
#include <fascia/math/ode/implicit_matrix.h>
#include <fascia/math/ode/integrator.h>

namespace fascia {
namespace {

// Rosenbrock 4(3) of Kaps & Rentrop with Shampine's coefficients (Numerical Recipes §16.6, eqs.
// 16.6.21–16.6.29, GAM = 1/2, and the routine stiff).
constexpr double kGamma = 0.5;
constexpr int kStages = 4;
constexpr double kA[3][2] = {{0, 0}, {2, 0}, {48.0 / 25, 6.0 / 25}};  // the fourth: as the third
constexpr double kC[kStages][3] = {
    {0, 0, 0}, {-8, 0, 0}, {372.0 / 25, 12.0 / 5, 0}, {-112.0 / 125, -54.0 / 125, -2.0 / 5}};
constexpr double kB[kStages] = {19.0 / 9, 1.0 / 2, 25.0 / 108, 125.0 / 108};
constexpr double kE[kStages] = {17.0 / 54, 7.0 / 36, 0, 125.0 / 108};
constexpr double kNode[3] = {0, 1, 3.0 / 5};                                    // A2X, A3X
constexpr double kTime[kStages] = {1.0 / 2, -3.0 / 2, 121.0 / 50, 29.0 / 250};  // C1X … C4X

// With y = (r, v), J = ∂y'/∂y, a stage solves (1/(γh) − J) (g_r, g_v) = (p, q). Its first row gives
// g_r = γh (p + g_v); put into the second, times M, there is one system of half the size:
//   (M/(γh) − ∂f/∂v − γh ∂f/∂r) g_v = M q + γh ∂f/∂r p,
// here times γh, so that all stages share M − γh ∂f/∂v − (γh)² ∂f/∂r.
class Rosenbrock4 final : public Integrator {
 public:
  std::string_view name() const override { return "rosenbrock4"; }
  int order() const override { return 4; }
  int embeddedOrder() const override { return 3; }

  double step(SecondOrderSystem& system, const OdeState& from, double h, OdeState& to) override {
    FASCIA_ASSERT(from.r.size() == system.size() && from.v.size() == system.size(),
                  "the state fits the system");
    FASCIA_ASSERT(h > 0, "time goes on");
    resize(system.size(), to);
    to.t_s = from.t_s + h;
    const double gammaH_s = kGamma * h;
    if (!matrix_.update(system, from.t_s, from.r, from.v, gammaH_s, gammaH_s * gammaH_s)) {
      return kStepFailed;
    }
    timeDerivative(system, from, h);
    for (int stage = 0; stage < kStages; ++stage) {
      if (stage < 3) evaluateStage(system, from, h, stage);
      if (!solveStage(system.inverseMass(), h, stage)) return kStepFailed;
    }
    combine(from, to);
    return scaledNorm(from.r, settings_.position_scale,
                      [&](std::size_t i) { return weighted(gR_, kE, i); });
  }

 private:
  using Stages = std::array<std::vector<double>, kStages>;

  void resize(std::size_t n, OdeState& to) {
    to.resize(n), force_.resize(n), forceRate_.resize(n), stageR_.resize(n), stageV_.resize(n);
    for (int s = 0; s < kStages; ++s) gR_[s].resize(n), gV_[s].resize(n);
    const auto size = static_cast<Eigen::Index>(n);
    slope_.resize(size), right_.resize(size);
  }

  // ∂f/∂t by central differences over a thousandth of the step: round-off and truncation then both
  // stay far below the method's own error.
  void timeDerivative(SecondOrderSystem& system, const OdeState& from, double h) {
    std::ranges::fill(forceRate_, 0.0);
    if (!system.forcesDependOnTime()) return;
    const double later = from.t_s + 1e-3 * h, earlier = from.t_s - 1e-3 * h;
    if (!(later > earlier)) return;
    evaluateForces(system, later, from.r, from.v, forceRate_);
    evaluateForces(system, earlier, from.r, from.v, force_);
    for (std::size_t i = 0; i < force_.size(); ++i)
      forceRate_[i] = (forceRate_[i] - force_[i]) / (later - earlier);
  }

  void evaluateStage(SecondOrderSystem& system, const OdeState& from, double h, int stage) {
    const double a0 = kA[stage][0], a1 = kA[stage][1];
    for (std::size_t i = 0; i < force_.size(); ++i) {
      stageR_[i] = from.r[i];
      stageV_[i] = from.v[i];
      if (stage > 0) stageR_[i] += a0 * gR_[0][i], stageV_[i] += a0 * gV_[0][i];
      if (stage > 1) stageR_[i] += a1 * gR_[1][i], stageV_[i] += a1 * gV_[1][i];
    }
    evaluateForces(system, from.t_s + kNode[stage] * h, stageR_, stageV_, force_);
  }

  bool solveStage(std::span<const double> w, double h, int stage) {
    const double gammaH_s = kGamma * h;
    for (std::size_t i = 0; i < force_.size(); ++i) {
      double p = stageV_[i], q = 0;
      for (int s = 0; s < stage; ++s) {
        p += kC[stage][s] / h * gR_[s][i];
        q += kC[stage][s] / h * gV_[s][i];
      }
      slope_[static_cast<Eigen::Index>(i)] = p;
      right_[static_cast<Eigen::Index>(i)] =
          w[i] > 0 ? force_[i] + h * kTime[stage] * forceRate_[i] + q / w[i] : 0;
    }
    right_ = gammaH_s * right_ + gammaH_s * gammaH_s * (matrix_.forceByPosition() * slope_);
    for (std::size_t i = 0; i < force_.size(); ++i) {
      if (!(w[i] > 0)) right_[static_cast<Eigen::Index>(i)] = 0;
    }
    if (!matrix_.solve(right_, solution_)) return false;
    for (std::size_t i = 0; i < force_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      gV_[stage][i] = solution_[k];
      gR_[stage][i] = gammaH_s * (slope_[k] + solution_[k]);
    }
    return true;
  }

  static double weighted(const Stages& g, const double (&weight)[kStages], std::size_t i) {
    return weight[0] * g[0][i] + weight[1] * g[1][i] + weight[2] * g[2][i] + weight[3] * g[3][i];
  }

  void combine(const OdeState& from, OdeState& to) const {
    for (std::size_t i = 0; i < force_.size(); ++i) {
      to.r[i] = from.r[i] + weighted(gR_, kB, i);
      to.v[i] = from.v[i] + weighted(gV_, kB, i);
    }
  }

  ImplicitMatrix matrix_;
  std::vector<double> force_, forceRate_, stageR_, stageV_;
  Stages gR_, gV_;
  Eigen::VectorXd slope_, right_, solution_;
};

}  // namespace

std::unique_ptr<Integrator> makeRosenbrock4() {
  return std::make_unique<Rosenbrock4>();
}

}  // namespace fascia
