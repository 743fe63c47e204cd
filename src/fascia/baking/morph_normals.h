#pragma once

#include <span>
#include <vector>

#include <fascia/baking/morph_basis.h>

namespace fascia {

// How the targets of a basis turn a surface's normals: what each adds, at its full weight, to the
// normal at rest, before the bones turn it. Fitted to the normals of all frames, as the targets'
// own shapes say little of a frame in which many of them are at work.
// Targets, points; zero where neither a target nor what it moves touches a point's triangles.
std::vector<std::vector<Eigen::Vector3f>> fitMorphNormals(
    std::span<const Eigen::Vector3f> restNormals,
    std::span<const std::array<std::uint32_t, 3>> triangles, std::span<const PointWeights> weights,
    const std::vector<std::vector<Transform>>& bones, const PointFrames& frames,
    const MorphBasis& basis);

}  // namespace fascia
