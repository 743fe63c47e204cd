#pragma once

#include <fascia/flesh/flesh.h>
#include <fascia/geometry/triangle_mesh.h>
#include <fascia/rig/rigged_model.h>
#include <fascia/skin/def/skin_def.h>

namespace fascia {

// How long the edges of a skin around these solids are: as asked for, but no longer than an eighth
// of the figure.
double surfaceEdge_m(const DistanceField& flesh, const SkinSurfaceDef& def);

// More points than any figure needs; bounds what a hostile file can cost.
inline constexpr double kMostSurfacePoints = 1 << 18;

// Whether it would have more of them, by a coarse look at its area.
bool isTooFine(const DistanceField& flesh, const SkinSurfaceDef& def, double fat_m);

// The surface of all solids together at a distance of the fat, as even triangles: closed,
// 2-manifold and without hollows. Empty where all solids are much smaller than the edges.
TriangleMesh surfaceOfSolids(const DistanceField& flesh, const SkinSurfaceDef& def, double fat_m);

// Which joints are near to each point: shares that fall off with the distance to their solids.
// `reach_m`: joints farther away than the nearest by this have none.
std::vector<PointWeights> sharesOfJoints(const Flesh& flesh, const DistanceField& posed,
                                         std::size_t joints, const VectorArray& points,
                                         std::size_t count, double reach_m);

}  // namespace fascia
