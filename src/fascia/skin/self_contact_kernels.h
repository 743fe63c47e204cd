#pragma once

#include <array>
#include <cstdint>

#include <fascia/base/aligned.h>
#include <fascia/skin/self_contact_model.h>

namespace fascia {

// SIMD kernels that find which points may touch which triangles; dispatched at run time.

// The surface as it lies now.
struct SurfaceFrame {
  VectorArray areaNormal;    // per triangle: twice its area long; one more, 0, for missing ones
  FloatArray inverseLength;  // of areaNormal; 0 for a triangle without area
  VectorArray corner;        // per triangle: its first corner
  VectorArray low, high;     // per triangle: its box
  VectorArray normal;        // per point: unit, or 0

  explicit SurfaceFrame(const SelfContactModel& model);
  SurfaceFrame() = default;
};

// All directions within an angle to an axis.
struct NormalCone {
  float axis[3];
  float cosine;
};

// Where some points are, how they move, and where their surface looks.
struct MotionBounds {
  float low[3], high[3];         // m
  float slowest[3], fastest[3];  // m/s
  NormalCone normals;
};

// The points of one block.
struct PointLanes {
  template <class T>
  using Lanes = std::array<T, PointBlock::kCapacity>;
  struct alignas(64) Lanes3 {
    Lanes<float> x, y, z;
  };
  std::uint32_t count;
  Lanes3 place, normal;  // behind the last point repeating the first one
};

// How a block and a group of triangles can meet until the end of the interval.
struct PairReach {
  float low[3], high[3];     // box that triangles must touch
  float below[3], above[3];  // how far around a triangle's box its points may be
  float ahead_m;             // how far in front of a triangle
  float depthScale;          // times depth_m: how far behind
};

struct Candidate {
  std::uint32_t lane, triangle;
};
inline constexpr std::size_t kMostCandidates =
    PointBlock::kCapacity * SelfContactModel::Group::kCapacity;

// Cosine of a point's and a triangle's normals above which they do not face each other. Smoothed
// normals, which decide in the end, differ from a triangle's own.
inline constexpr float kMayFace = 0.5f;

// Normals and boxes of a group's triangles, and bounds of the whole group.
MotionBounds updateGroup(const SelfContactModel& model, std::size_t group,
                         const VectorArray& position, const VectorArray& velocity,
                         SurfaceFrame& frame);

// Normals of the points [chunk * kLanes, (chunk + 1) * kLanes), after all groups.
void updateNormals(const SelfContactModel& model, std::size_t chunk, SurfaceFrame& frame);

MotionBounds loadLanes(const PointBlock& block, const VectorArray& position,
                       const VectorArray& velocity, const SurfaceFrame& frame, PointLanes& lanes);

// Points and triangles that may touch, triangle by triangle; returns how many.
std::size_t findCandidates(const SelfContactModel& model, std::size_t group,
                           const SurfaceFrame& frame, const PointLanes& lanes,
                           const PairReach& reach, std::array<Candidate, kMostCandidates>& out);

}  // namespace fascia
