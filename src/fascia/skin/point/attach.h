#pragma once

#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/field/field.h>

namespace fascia {

// Where a strand of tissue begins.
struct Attachment {
  SolidId solid;
  Vec3 place_m = Vec3::Zero();  // world, on the solid's surface
};

// Points that lie together, at most NearestSolids::kBlock.
struct PointRun {
  std::size_t first, number, count;  // storage index, place in results
};

// "Attach all" (Turner & Gobbetti 1998, §4): every point to the flesh that its inward normal meets,
// or to the nearest flesh at all where the normal meets none within four times that distance and
// fat_m more. `runs` in the order of their numbers, which leave no gap.
std::vector<Attachment> attachAlongNormals(const DistanceField& field,
                                           std::span<const PointRun> runs,
                                           const VectorArray& points_m, const VectorArray& normals,
                                           double fat_m);

// The solid nearest to each point, by the same numbers.
std::vector<SolidId> nearestSolids(const DistanceField& field, std::span<const PointRun> runs,
                                   const VectorArray& points_m);

}  // namespace fascia
