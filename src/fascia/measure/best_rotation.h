#pragma once

#include <fascia/math/types.h>

namespace fascia {

// The rotation R that fits vectors b to vectors a best: it maximises Σ a·(R b) = tr(Rᵀ M),
// M = Σ a bᵀ. Never a reflection; flat sets have one too. Where several fit equally well (all
// vectors on one line), one of them.
Mat3 bestRotation(const Mat3& M);

}  // namespace fascia
