#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/math/types.h>

namespace fascia {

// The area, as seen from far away, of those of a surface's triangles that face the viewer and are
// not hidden behind others. `towards`: unit, from the surface to the viewer. Found on a grid of
// 128 × 128 lines of sight around the chosen triangles; points that are no numbers hide nothing.
double visibleArea(std::span<const std::array<std::uint32_t, 3>> surface,
                   std::span<const Eigen::Vector3f> points, const std::vector<bool>& chosen,
                   const Vec3& towards);

}  // namespace fascia
