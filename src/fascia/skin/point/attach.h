#pragma once

#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/field/field.h>
#include <fascia/skin/grid/grid_layout.h>

namespace fascia {

// Where a strand of tissue begins.
struct Attachment {
  SolidId solid;
  Vec3 place_m = Vec3::Zero();  // world, on the solid's surface
};

// "Attach all" (Turner & Gobbetti 1998, §4): every point of the grid to the flesh that its inward
// normal meets, or to the nearest flesh at all where the normal meets none within four times that
// distance and fat_m more. In the order of the points, row by row, ends included.
std::vector<Attachment> attachAlongNormals(const DistanceField& field, const GridLayout& layout,
                                           const VectorArray& points_m, const VectorArray& normals,
                                           double fat_m);

// The solid nearest to each point, in the same order.
std::vector<SolidId> nearestSolids(const DistanceField& field, const GridLayout& layout,
                                   const VectorArray& points_m);

}  // namespace fascia
