#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include <assimp/matrix4x4.h>

#include <fascia/rig/rigged_model.h>

struct aiNode;
struct aiScene;

namespace fascia {

using AssimpFrame = Eigen::Affine3d;

// Part of readWithAssimp(): the library's nodes in one list, parents first, in metres.
class AssimpNodes {
 public:
  AssimpNodes(const aiScene& scene, double unit_m);

  std::size_t size() const { return nodes_.size(); }
  const aiNode& node(std::size_t n) const { return *nodes_[n]; }
  int parent(std::size_t n) const { return parents_[n]; }
  const AssimpFrame& world(std::size_t n) const { return world_[n]; }
  int find(const std::string& name) const;  // -1: none

  // World frames for other frames of the nodes in their parents'.
  void pose(const std::vector<AssimpFrame>& local, std::vector<AssimpFrame>& world) const;

 private:
  std::vector<const aiNode*> nodes_;
  std::vector<int> parents_;
  std::vector<AssimpFrame> world_;
  std::unordered_map<std::string, int> byName_;
  double unit_m_ = 1;
};

AssimpFrame affineOf(const aiMatrix4x4& matrix);
Transform rigidOf(const AssimpFrame& frame);  // without scale and shear

// All animations at a constant rate, as the model's motions.
void sampleMotions(const aiScene& scene, const AssimpNodes& nodes,
                   const std::vector<std::size_t>& nodeOfJoint, RiggedModel& model);

}  // namespace fascia
