#pragma once

#include <fascia/math/ode/integrator.h>

namespace fascia {

// The longest step up to 1 s with which the method keeps an oscillation from growing,
//     r̈ = −ω² r − γ ṙ,   ω > 0 and γ ≥ 0 in 1/s;
// 0 if it makes it grow at any step, as explicit Euler does without damping. Found by what one step
// makes of the two unit states: the method is taken for linear, as all of the library are on such a
// system. Calls reset().
double longestStableStep_s(Integrator& integrator, double frequency_per_s, double damping_per_s);

}  // namespace fascia
