#pragma once

#include <string>
#include <vector>

#include <fascia/measure/deformation.h>
#include <fascia/rig/blend_skinning.h>

namespace fascia {

// What is wrong with a surface at one moment.
struct Faults {
  std::size_t crossings = 0;        // pairs of triangles that pass through each other, not at rest
  std::size_t turned = 0;           // triangles that show their back where they showed their front
  double stretch = 1;               // 99 % of the edges are stretched less
  std::vector<float> per_triangle;  // how bad it is there, times the share of the surface
  double sum() const;
};

// Finds faults of deformed surfaces of one model, which must outlive it.
class FaultFinder {
 public:
  explicit FaultFinder(const RiggedModel& model);

  // motion: of every joint from the bind pose, as the points were moved.
  Faults find(PointList points, std::span<const Transform> motion) const;
  // Share of the surface, per triangle.
  std::span<const float> areas() const { return areas_; }

 private:
  std::size_t findTurned(PointList points, std::span<const Transform> motion,
                         std::vector<float>& weights) const;
  void addStretch(PointList points, std::vector<float>& weights) const;

  const RiggedModel& model_;
  std::vector<float> areas_;
  std::vector<Eigen::Vector3f> normals_;  // of triangles at rest
  std::vector<CrossingPair> restCrossings_;
};

}  // namespace fascia
