#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include <Eigen/Core>

#include <fascia/base/aligned.h>
#include <fascia/skin/self_contact/self_contact_model.h>

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

// The points of one patch; lanes behind the last point repeat it.
struct PointLanes {
  template <class T>
  using Lanes = std::array<T, SelfContactModel::Patch::kCapacity>;
  struct alignas(64) Lanes3 {
    Lanes<float> x, y, z;
  };
  Lanes3 place, velocity, normal;
  alignas(64) Lanes<float> nearest_m;  // triangles farther from a point are not looked for
};

// How a patch and a group of triangles can meet until the end of the interval.
struct PairReach {
  float low[3], high[3];  // box of the points on their way, seen from the group
  float axis[3];          // of the points' normals: triangles that look …
  float cosineNever;      // … closer to it than this face none of them
  float ahead_m;          // how far in front of a triangle a point may be, …
  float interval_s;       // … and how long they may approach each other
  float depthScale;       // times depth_m: how far behind
  std::uint32_t lanes;    // bit by bit: which points
};

// A point near or behind a triangle that faces it.
struct Touch {
  std::uint32_t lane, triangle;
  float weightB, weightC;  // of the second and third corner, at the triangle's nearest point
  float normal[3];         // of the surface there: smoothed, unit
  float distance_m;        // along the normal; negative: the point is behind
  float nearest_m;         // to the nearest point, ≥ 0
  float facing;            // cosine of the two normals, less what it must be below

  Eigen::Vector3f weights() const { return {1 - weightB - weightC, weightB, weightC}; }
};
using TouchVisit = std::function<void(const Touch&)>;

// Normals of a group's triangles and so on, and bounds of the whole group.
MotionBounds updateGroup(const SelfContactModel& model, std::size_t group,
                         const VectorArray& position, const VectorArray& velocity,
                         SurfaceFrame& frame);

// Normals of the points [chunk * kLanes, (chunk + 1) * kLanes), after all groups.
void updateNormals(const SelfContactModel& model, std::size_t chunk, SurfaceFrame& frame);

MotionBounds loadLanes(const SelfContactModel& model, std::size_t patch,
                       const VectorArray& position, const VectorArray& velocity,
                       const SurfaceFrame& frame, PointLanes& lanes);

// Calls visit for all touches of the points and a group's triangles that are no farther than
// nearest_m, which it may lower. Leaves out what is too near on the surface.
void findTouches(const SelfContactModel& model, std::size_t patch, std::size_t group,
                 const VectorArray& position, const SurfaceFrame& frame, const PairReach& reach,
                 const PointLanes& lanes, const TouchVisit& visit);

// Cosine of a point's and a triangle's own normals above which they do not face each other. The
// smoothed normals, which decide in the end, may differ.
inline constexpr float kMayFace = 0.5f;

}  // namespace fascia
