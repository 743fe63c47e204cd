#pragma once

#include <span>
#include <vector>

#include <fascia/math/types.h>

namespace fascia {

// A closed curve through the points, as a polygon: a centripetal Catmull–Rom spline (Barry &
// Goldman 1988; Yuksel et al. 2011), which has no loops or cusps between neighbours. Two equal
// points in a row make a corner. Fewer than three points come back as they are.
std::vector<Vec2> closedCurve(std::span<const Vec2> points_m);

}  // namespace fascia
