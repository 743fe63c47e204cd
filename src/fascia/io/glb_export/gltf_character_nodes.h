#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <fascia/character/character.h>
#include <fascia/io/gltf/gltf_builder.h>

namespace fascia {

// The nodes of a character in a document of our own: its joints as a tree, and rigid meshes that
// ride on them.
class GltfCharacterNodes {
 public:
  GltfCharacterNodes(const Character& character, GltfBuilder& glb);

  // In the order of the skeleton's joints, as many. First of all, and once.
  void addJoints(std::vector<Json> nodes);
  // A node below a joint; at the top if that is invalid. Returns its index.
  int add(Json node, JointId parent);
  // Solids as they are at rest, `detail` segments around at most; fewer where nobody could tell.
  // Solids of one shape share their vertices.
  void addSolids(const Flesh& flesh, int detail);

  const std::vector<int>& joints() const { return joints_; }
  const std::vector<int>& roots() const { return roots_; }

 private:
  int materialOf(const Color& color);
  Json geometryOf(const Solid& solid, int detail);

  const Character& character_;
  GltfBuilder& glb_;
  double roundness_m_;
  std::vector<int> joints_, roots_;
  std::vector<std::pair<std::array<float, 3>, int>> materials_;  // by colour
  std::vector<std::pair<TriangleMesh, Json>> geometries_;        // and their primitives
};

// A joint's frame in its parent's; a root's in the world.
Transform localFrame(const Skeleton& skeleton, const PosedSkeleton& posed, std::size_t joint);

}  // namespace fascia
