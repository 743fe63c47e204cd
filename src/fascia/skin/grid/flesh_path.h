#pragma once

#include <vector>

#include <fascia/field/field.h>

namespace fascia {

// The way from one place to another that keeps to the flesh: from solid to solid through their
// middles, the shortest where a length near the surface counts several times and one outside of all
// solids many times, and then smoothed.
// `count` >= 2 places at even distances, both ends included.
std::vector<Vec3> pathThroughFlesh(const DistanceField& flesh, const Vec3& from, const Vec3& to,
                                   std::size_t count);

}  // namespace fascia
