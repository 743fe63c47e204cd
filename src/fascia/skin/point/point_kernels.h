#pragma once

#include <array>
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

// One block's points while they are tested against solids.
struct ContactLanes {
  template <class T>
  using Lanes = std::array<T, PointBlock::kCapacity>;
  struct alignas(64) Lanes3 {
    Lanes<float> x, y, z;
    Vectors view(std::size_t n) { return {x.data(), y.data(), z.data(), n}; }
  };
  Lanes3 place;                           // r, moved out of solids as they are visited
  Lanes3 normal;                          // written by Field::evaluate
  Lanes3 nearestNormal;                   // of the nearest solid so far
  Lanes3 pushNormal;                      // of the last solid that moved the point; 0 = none
  Lanes3 fleshVelocity;                   // of that solid's matter
  alignas(64) Lanes<float> fat;           // distance to keep
  alignas(64) Lanes<float> distance;      // written by Field::evaluate
  alignas(64) Lanes<float> nearest;       // gap between fat and nearest solid so far, ≥ 0
  alignas(64) Lanes<float> pushed;        // way out of solids in this visit
  alignas(64) Lanes<float> clearance;     // gap to the other solids; 0 if it was inside of two
  alignas(64) Lanes<float> nearestSolid;  // its number (a float, to blend like the rest)
};

struct BlockBox {
  float low[3], high[3];
};

// How a block's points went since they were last seen.
struct BlockMotion {
  float center[3], way[3];  // where the middle one was, and how far it went
  float radius_m;           // farthest that one was from there
  float spread_m;           // farthest that one's way is from that
};

// Loads a block's places and fat; returns the box of the points with their fat around them. With
// `last`, writes how the block moved since the positions there, and updates them.
BlockBox loadContactLanes(const PointBlock& block, const VectorArray& position,
                          const FloatArray& fat, ContactLanes& lanes, VectorArray* last = nullptr,
                          BlockMotion* motion = nullptr);

// Takes up the distances and normals to one solid: moves points that are inside out of it (if
// `move`), keeps the nearest. Returns the smallest gap found, negative = inside.
float absorbSolid(float solid, bool move, std::uint32_t count, ContactLanes& lanes);

// Packs the places of the points nearest to a solid that finishContact() asks its matter's velocity
// of: those within reach, and those that were moved. Returns how many; `lane` says which.
std::uint32_t packNearest(float solid, float reach_m, std::uint32_t count,
                          const ContactLanes& lanes, ContactLanes::Lanes3& place,
                          ContactLanes::Lanes<std::int32_t>& lane);

// What was found out about a run of points, from its first on.
struct ContactFindings {
  ConstVectors place;          // where contact has moved them
  const float* nearest;        // gap to the nearest solid, ≥ 0
  ConstVectors normal;         // of that solid
  ConstVectors fleshVelocity;  // of its matter
};

// Writes the result of a block: moved positions, velocities without their approaching part, half
// spaces. `any` = false: nothing is within reach. Returns the largest squared speed
// relative to the anchors.
float finishContact(const PointBlock& block, bool any, float reach_m, float restitution,
                    const PointModel& points, const ContactFindings& found, VectorArray& position,
                    VectorArray& velocity, PointSurroundings& around);

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
