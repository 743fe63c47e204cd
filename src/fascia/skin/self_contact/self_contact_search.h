#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include <fascia/geometry/box_tree.h>
#include <fascia/skin/self_contact/self_contact_kernels.h>
#include <fascia/skin/self_contact/self_contact_model.h>

namespace fascia {

// Finds the points of a skin that are near triangles of its other parts.
class SurfaceSearch {
 public:
  SurfaceSearch() = default;
  explicit SurfaceSearch(const SelfContactModel& model);

  // Normals, boxes and the tree for the surface as it lies and moves now.
  void update(const VectorArray& position, const VectorArray& velocity, float interval_s);

  // Calls visit(group, touch) for all that the patch's points touch, or may reach within the
  // interval: a distance of ahead_m plus the way that both go towards each other. Left out is what
  // is too near on the surface, and what is farther than `lanes.nearest_m`, which visit may lower.
  // `depthScale` times depth_m is how deep a point may be.
  struct Query {
    float ahead_m, depthScale;
    const VectorArray &position, &velocity;  // as in update
  };
  using Visit = std::function<void(std::uint32_t group, const Touch&)>;
  void search(std::size_t patch, const Query& query, PointLanes& lanes, const Visit& visit) const;

 private:
  bool meet(const MotionBounds& points, std::uint32_t group, const Query& query,
            PairReach& out) const;

  const SelfContactModel* model_ = nullptr;
  float interval_s_ = 0;
  SurfaceFrame frame_;
  std::vector<MotionBounds> groups_;
  std::vector<Box> boxes_;  // of groups, over the whole interval, seen from the mean motion
  Vec3 meanVelocity_ = Vec3::Zero();
  BoxTree tree_;
};

}  // namespace fascia
