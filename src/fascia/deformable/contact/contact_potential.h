#pragma once

#include <algorithm>
#include <cmath>

namespace fascia {

// What a gap d between two surfaces costs: nothing beyond the margin δ, and then
//     ψ(d) = k δ [δ ln(δ/d) − (δ − d)],   −ψ' = k δ (δ − d)/d,   ψ'' = k δ²/d²,
// a spring of stiffness k at the margin's edge that hardens in proportion to what it has to carry,
// so that light bodies do not make the steps' equations stiff and heavy ones still stay outside.
// It is the logarithm of the barrier of Li et al. 2020 (IPC, eq. 6) without its square, which would
// be softer at the edge. Unlike there it does not end at d = 0: below δ/16 it goes on as a
// parabola, because bodies may be placed inside of each other, and because distances are estimates.
struct GapEnergy {
  double margin_m = 0, stiffness_N_per_m = 0;  // δ, k

  // A smaller part carries more (31 k δ at d = 0) and makes Newton's method double d more often.
  static constexpr double kParabola = 1.0 / 16;

  double value_J(double gap_m) const {
    const double x = gap_m / margin_m, unit_J = stiffness_N_per_m * margin_m * margin_m;
    if (x >= 1) return 0;
    if (x >= kParabola) return unit_J * (x - 1 - std::log(x));
    const double below = kParabola - x;
    const double start = kParabola - 1 - std::log(kParabola);
    return unit_J * (start + below * (kSlope + 0.5 * kCurvature * below));
  }
  double force_N(double gap_m) const {  // −ψ', never negative
    const double x = gap_m / margin_m, unit_N = stiffness_N_per_m * margin_m;
    if (x >= 1) return 0;
    if (x >= kParabola) return unit_N * (1 - x) / x;
    return unit_N * (kSlope + kCurvature * (kParabola - x));
  }
  double curvature_N_per_m(double gap_m) const {
    const double x = std::max(gap_m / margin_m, kParabola);
    return x >= 1 ? 0 : stiffness_N_per_m / (x * x);
  }

 private:
  static constexpr double kSlope = (1 - kParabola) / kParabola;
  static constexpr double kCurvature = 1 / (kParabola * kParabola);
};

// Coulomb's friction as a potential of the way y slid in a step, times µ λ with a normal force λ
// that is held while it is differentiated (Li et al. 2020, §5.4, eqs. 17–18): f(y) = y − ε/3 beyond
// ε, and below it smooth, so that what sticks creeps by less than ε in a step.
struct SlideEnergy {
  double smoothing_m = 0;  // ε

  double value_m(double y) const {
    const double e = smoothing_m;
    return y >= e ? y - e / 3 : y * y / e * (1 - y / (3 * e));
  }
  double slopeOverWay_per_m(double y) const {  // f'/y
    const double e = smoothing_m;
    return y >= e ? 1 / y : (2 - y / e) / e;
  }
  double curvature_per_m(double y) const {  // f''
    const double e = smoothing_m;
    return y >= e ? 0 : 2 * (1 - y / e) / e;
  }
};

}  // namespace fascia
