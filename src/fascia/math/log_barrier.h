#pragma once

#include <algorithm>
#include <cmath>

namespace fascia {

// What it costs to come near to d = 0: nothing beyond the margin δ, and then
//     ψ(d) = k δ [δ ln(δ/d) − (δ − d)],   −ψ' = k δ (δ − d)/d,   ψ'' = k δ²/d²,
// a spring of stiffness k at the margin's edge that hardens in proportion to what it has to carry,
// so that light loads do not make equations stiff and heavy ones still stay outside. It is the
// logarithm of the barrier of Li et al. 2020 (IPC, eq. 6) without its square, which would be softer
// at the edge. Unlike there it does not end at d = 0: below δ/16 it goes on as a parabola, because
// states may begin beyond it. Units are the caller's: d in m and k in N/m for gaps.
struct LogBarrier {
  double margin = 0, stiffness = 0;  // δ, k
  // Where the parabola begins, in parts of the margin. A smaller part carries more (31 k δ at d =
  // 0) and makes Newton's method double d more often.
  double parabola = 1.0 / 16;

  double value(double d) const {
    const double x = d / margin, unit = stiffness * margin * margin;
    if (x >= 1) return 0;
    if (x >= parabola) return unit * (x - 1 - std::log(x));
    const double below = parabola - x;
    const double start = parabola - 1 - std::log(parabola);
    return unit * (start + below * (slope() + 0.5 * bend() * below));
  }
  double force(double d) const {  // −ψ', never negative
    const double x = d / margin, unit = stiffness * margin;
    if (x >= 1) return 0;
    if (x >= parabola) return unit * (1 - x) / x;
    return unit * (slope() + bend() * (parabola - x));
  }
  double curvature(double d) const {
    const double x = std::max(d / margin, parabola);
    return x >= 1 ? 0 : stiffness / (x * x);
  }

 private:
  double slope() const { return (1 - parabola) / parabola; }  // there, of ψ/(k δ²) by d/δ
  double bend() const { return 1 / (parabola * parabola); }
};

}  // namespace fascia
