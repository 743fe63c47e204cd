#pragma once

#include <fascia/math/types.h>

namespace fascia {

// The rotation nearest to F in the sum of squares (polar decomposition); a proper one also where F
// mirrors.
Mat3 nearestRotation(const Mat3& F);

}  // namespace fascia
