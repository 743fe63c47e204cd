#pragma once

#include <cstddef>
#include <cstdint>

#include <fascia/base/aligned.h>
#include <fascia/skin/point/point_model.h>

namespace fascia {

// SIMD kernels over points, whatever connects them; dispatched at run time.

// Runs of consecutive points in storage order, the unit in which points are tested against solids.
// Kernels work on whole vectors: reading and rewriting up to 15 entries behind the run is harmless,
// because rows end in padding.
struct PointBlock {
  static constexpr std::size_t kCapacity = 32;  // two of the widest vectors hide latency
  std::size_t first;
  std::uint32_t count;
};

// Anchor velocities of the coming interval. What anchors change in velocity, the flesh of the half
// spaces beside them does too; velocities of points with added mass follow in part (see leapfrog.h;
// `carry` may be null). Returns the largest squared way of an anchor. All arrays in whole.
float followAnchors(const VectorArray& nextAnchor, float rate_per_s, const FloatArray* carry,
                    PointSurroundings& around, VectorArray& velocity);

// The same for points that ride on a coarse surface: `next` is its velocity, `coarseVelocity` what
// it was; writes next to coarseVelocity.
void followCoarse(const VectorArray& next, const FloatArray& carry, VectorArray& coarseVelocity,
                  VectorArray& velocity);

// True if any entry in [first, last) is not finite, beyond 1e9 m, or faster than `fastest`
// relative to its anchor.
bool anyBroken(const VectorArray& position, const VectorArray& velocity,
               const VectorArray& anchorVelocity, float fastest_m_per_s, std::size_t first,
               std::size_t last);

}  // namespace fascia
