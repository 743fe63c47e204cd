#pragma once

namespace fascia {

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
