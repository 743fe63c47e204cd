#pragma once

#include <fascia/math/ode/integrator.h>

namespace fascia {

// The state at a time between two: cubic, as the velocities at both ends say (Hermite); at and
// beyond the ends these themselves. `out` is neither of the two; allocates only while it grows.
void between(const OdeState& from, const OdeState& to, double time_s, OdeState& out);

}  // namespace fascia
