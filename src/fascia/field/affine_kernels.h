#pragma once

#include <fascia/base/aligned.h>
#include <fascia/math/types.h>

namespace fascia {

// out = matrix (in − from) + to for many points, SIMD, in float: subtracting first keeps the digits
// far from the origin. Arrays need no alignment; `out` may be `in`.
void affinePoints(const Mat3& matrix, const Vec3& from, const Vec3& to, ConstVectors in,
                  Vectors out);

}  // namespace fascia
