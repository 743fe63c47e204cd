#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// Normals of an imported surface as it deforms. Where the file's own normals agree around a point
// the surface stays smooth, where they differ (hard edges, facets) it stays creased; in the bind
// pose they are the file's.
class CreaseNormals {
 public:
  explicit CreaseNormals(const RiggedModel& model);

  // For points in the order of RiggedModel::vertices; `normals` gets as many, unit.
  void compute(std::span<const Eigen::Vector3f> positions,
               std::vector<Eigen::Vector3f>& normals) const;

 private:
  void sum(std::span<const Eigen::Vector3f> positions, std::vector<Eigen::Vector3f>& normals) const;

  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::uint32_t> first_;       // vertex -> the first one that shares its normal
  std::vector<Eigen::Vector3f> rest_;      // per vertex: computed from the bind pose
  std::vector<Eigen::Vector3f> authored_;  // per vertex: the file's
};

}  // namespace fascia
