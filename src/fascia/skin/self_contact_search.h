#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include <fascia/geometry/box_tree.h>
#include <fascia/skin/self_contact_kernels.h>
#include <fascia/skin/self_contact_model.h>

namespace fascia {

// A point near or behind a triangle that faces it.
struct Touch {
  std::uint32_t point, triangle, group;
  Eigen::Vector3f weights;  // of the triangle's nearest point
  Eigen::Vector3f normal;   // of the surface there, smoothed, unit
  float distance_m;         // along the normal; negative: the point is behind
  float nearest_m;          // to the triangle's nearest point, ≥ 0
  float facing;             // cosine of the two normals …
  float facingLimit;        // … and what it must be below
};

// Finds the points of a skin that are near triangles of its other parts.
class SurfaceSearch {
 public:
  SurfaceSearch() = default;
  explicit SurfaceSearch(const SelfContactModel& model);

  // Normals, boxes and the tree for the surface as it lies and moves now.
  void update(const VectorArray& position, const VectorArray& velocity, float interval_s);

  // Calls visit(Touch) for all that the block's points touch, or may reach within the interval:
  // distance ≤ ahead_m plus the way that both go towards each other. Left out is what is too near
  // on the surface. `depthScale` times depth_m is how deep a point may be. With `nearestOnly` only
  // a point's nearest touch is sure to be among them.
  struct Query {
    float ahead_m, depthScale;
    bool nearestOnly;
    const VectorArray &position, &velocity;  // as in update
  };
  using Visit = std::function<void(const Touch&)>;
  void search(std::size_t block, const Query& query, const Visit& visit) const;

 private:
  bool meet(const MotionBounds& points, std::uint32_t group, const Query& query,
            PairReach& out) const;
  bool touches(const Query& query, Touch& touch) const;

  const SelfContactModel* model_ = nullptr;
  float interval_s_ = 0;
  SurfaceFrame frame_;
  std::vector<MotionBounds> groups_;
  std::vector<Box> boxes_;  // of groups, over the whole interval, seen from the mean motion
  Vec3 meanVelocity_ = Vec3::Zero();
  BoxTree tree_;
};

}  // namespace fascia
