#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <fascia/base/aligned.h>
#include <fascia/field/kernels.h>
#include <fascia/skin/flesh_sense.h>

namespace fascia {

// SIMD kernels for pairs of points and solids (see FleshSense); dispatched at run time.

// Of what is not felt, or not known; its negative is below every gap.
inline constexpr float kFarAway = 1e30f;
inline constexpr std::size_t kFeltSize = FleshSense::kChunk + FleshSense::kPad;

struct alignas(kSimdAlignment) FeltVectors {
  std::array<float, kFeltSize> x, y, z;
  Vectors view(std::size_t n) { return {x.data(), y.data(), z.data(), n}; }
};
using FeltFloats = std::array<float, kFeltSize>;

// A chunk's points while they are tested. The entry behind the last is where pads read and write.
struct alignas(kSimdAlignment) FeltLanes {
  FeltVectors place;          // moved out of solids as they are visited
  FeltVectors nearestNormal;  // of the nearest solid so far
  FeltVectors pushNormal;     // of the last solid that moved the point; 0 = none
  FeltVectors fleshVelocity;  // of the nearest solid's matter
  FeltFloats fat;             // distance to keep
  FeltFloats nearest;         // gap between fat and nearest solid so far, ≥ 0
  FeltFloats nearestSolid;    // which one (a float, to blend like the rest)
  FeltFloats pushed;          // way out of solids in this pass
  FeltFloats way;             // the same in all passes
  FeltFloats limit;           // pairs with a larger bound are not worth asking
};

// Pairs of one solid that are evaluated together.
struct alignas(kSimdAlignment) FeltBatch {
  std::size_t count = 0;
  std::array<std::int32_t, kFeltSize> pair, point;  // pair: less the group's first
  FeltVectors place;
  FeltVectors answer;  // normals or velocities, whichever was asked for
  FeltFloats gap;      // distance less fat
};

// What is known of a group's pairs from when they were last evaluated, as pointers to the first.
struct FeltMemory {
  Vectors place;         // then, in the solid's frame
  float *lower, *upper;  // bounds of the gap, while the point does not move in that frame
  const float* yield;    // what is added to the gap: how deep the point may be now
};

// A solid as a group sees it.
struct FeltSolid {
  KernelFrame frame;
  float swelling_m = 0;  // how far its surface may have moved in its frame since the last time
};

// Bounds of the gaps now, from what is known and how far points have gone in the solid's frame
// since. Swelling goes into the memory. Writes the lower bounds, and lowers `limit` of points to
// the upper bounds (if `lowerLimits`).
void boundPairs(const FeltSolid& solid, std::span<const std::int32_t> point,
                const FeltMemory& memory, bool lowerLimits, FeltLanes& lanes, float* bound);

// Collects the pairs whose bound is not above their point's limit, with their places.
void selectPairs(std::span<const std::int32_t> point, const float* bound, const FeltLanes& lanes,
                 FeltBatch& batch);
// Those of points that have `solid` as their nearest, not farther than their limit.
void selectNearest(std::span<const std::int32_t> point, float solid, const FeltLanes& lanes,
                   FeltBatch& batch);

// Turns the batch's distances into gaps.
void subtractFat(const FeltLanes& lanes, FeltBatch& batch);
// Keeps the batch's gaps and places for later calls.
void rememberPairs(const KernelFrame& frame, const FeltBatch& batch, const FeltMemory& memory);

// Like absorbSolid, for the points of a batch.
void absorbPairs(float solid, bool move, const FeltBatch& batch, FeltLanes& lanes);

}  // namespace fascia
