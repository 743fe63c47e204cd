#pragma once

#include <cstdint>
#include <span>

#include <fascia/field/field.h>

namespace fascia {

// A place near `from` that keeps `fat_m` from every one of `solids` (numbers of the field's). For
// points that cannot be brought out of one solid after the other: in a narrow crease that takes
// hundreds of turns, in a pocket that solids close it never ends. Costs as much as testing some
// dozens of points. Where the solids' distances are exact and the solids convex, one step of the
// first kind suffices.
Vec3 leaveAll(const DistanceField& field, std::span<const std::int32_t> solids, double fat_m,
              const Vec3& from);

}  // namespace fascia
