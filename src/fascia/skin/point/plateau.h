#pragma once

#include <algorithm>
#include <cmath>

namespace fascia {

// Stress φ that is linear in the strain and stops growing at the plateau, and its integral.
inline double plateauStress(double t, double limit) {
  return std::clamp(t, -limit, limit);
}
inline double plateauEnergy(double t, double limit) {
  const double s = std::abs(t);
  return s <= limit ? 0.5 * s * s : limit * s - 0.5 * limit * limit;
}

}  // namespace fascia
