#pragma once

#include <array>
#include <cstdint>

#include <fascia/base/aligned.h>
#include <fascia/skin/self_contact_model.h>

namespace fascia {

// SIMD kernels that find which points may touch which triangles; dispatched at run time.

// The surface as it lies and moves now.
struct SurfaceFrame {
  VectorArray areaNormal;    // per triangle: twice its area long; one more, 0, for missing ones
  FloatArray inverseLength;  // of areaNormal; 0 for a triangle without area
  VectorArray center;        // per triangle
  FloatArray radius;         // of the sphere around center that holds the triangle
  VectorArray velocity;      // of center
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

// The points of one block; lanes behind the last point repeat the first one.
struct PointLanes {
  template <class T>
  using Lanes = std::array<T, PointBlock::kCapacity>;
  struct alignas(64) Lanes3 {
    Lanes<float> x, y, z;
  };
  std::uint32_t count;
  Lanes3 place, velocity, normal;
  // No farther than this is the nearest triangle that the point touches.
  alignas(64) Lanes<float> nearest_m;
};

// How a block and a group of triangles can meet until the end of the interval.
struct PairReach {
  float low[3], high[3];  // box of the points on their way, seen from the group
  float axis[3];          // of the points' normals: triangles that look …
  float cosineNever;      // … closer to it than this face none of them
  float ahead_m;          // how far in front of a triangle a point may be, …
  float interval_s;       // … and how long they may approach each other
  float depthScale;       // times depth_m: how far behind
  std::uint32_t lanes;    // bit by bit: which points
};

struct Candidate {
  std::uint32_t lane, triangle;
  float least_m;  // the triangle is no nearer than this
};
inline constexpr std::size_t kMostCandidates =
    PointBlock::kCapacity * SelfContactModel::Group::kCapacity;

// Cosine of a point's and a triangle's normals above which they do not face each other. Smoothed
// normals, which decide in the end, differ from a triangle's own.
inline constexpr float kMayFace = 0.5f;
// A point that is farther beside a triangle than this many times its height over it or depth below
// it has nothing to do with it.
inline constexpr float kSteepest = 1.2f;

// Normals and boxes of a group's triangles, and bounds of the whole group.
MotionBounds updateGroup(const SelfContactModel& model, std::size_t group,
                         const VectorArray& position, const VectorArray& velocity,
                         SurfaceFrame& frame);

// Normals of the points [chunk * kLanes, (chunk + 1) * kLanes), after all groups.
void updateNormals(const SelfContactModel& model, std::size_t chunk, SurfaceFrame& frame);

MotionBounds loadLanes(const PointBlock& block, const VectorArray& position,
                       const VectorArray& velocity, const SurfaceFrame& frame, PointLanes& lanes);

// Points and triangles that may touch and are not too far for nearest_m, triangle by triangle;
// returns how many. With `lower`, lowers nearest_m to what distances to centres tell for certain.
std::size_t findCandidates(const SelfContactModel& model, std::size_t group,
                           const SurfaceFrame& frame, const PairReach& reach, bool lower,
                           PointLanes& lanes, std::array<Candidate, kMostCandidates>& out);

}  // namespace fascia
