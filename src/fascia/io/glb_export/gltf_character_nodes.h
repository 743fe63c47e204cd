#pragma once

#include <string>
#include <utility>
#include <vector>

#include <fascia/character/character.h>
#include <fascia/io/gltf/glb_builder.h>

namespace fascia {

// The nodes of a character in a document of our own: its joints as a tree, and rigid meshes that
// ride on them.
class GltfCharacterNodes {
 public:
  GltfCharacterNodes(const Character& character, GlbBuilder& glb);

  // In the order of the skeleton's joints, as many. First of all, and once.
  void addJoints(std::vector<GlbBuilder::Json> nodes);
  // A node below a joint; at the top if that is invalid. Returns its index.
  std::size_t add(GlbBuilder::Json node, JointId parent);
  // Solids as they are at rest, `detail` segments around at most; fewer where nobody could tell.
  // Solids of one shape share their vertices.
  void addSolids(const Flesh& flesh, int detail);

  const std::vector<std::size_t>& joints() const { return joints_; }
  const std::vector<std::size_t>& roots() const { return roots_; }

 private:
  std::size_t materialOf(const Color& color);
  GlbBuilder::Json geometryOf(const Solid& solid, int detail);

  const Character& character_;
  GlbBuilder& glb_;
  double roundness_m_;
  std::vector<std::size_t> joints_, roots_;
  std::vector<std::pair<GlbBuilder::Json, std::size_t>> materials_;
  std::vector<std::pair<TriangleMesh, GlbBuilder::Json>> geometries_;  // and their primitives
};

// A joint's frame in its parent's; a root's in the world.
Transform localFrame(const Skeleton& skeleton, const PosedSkeleton& posed, std::size_t joint);

}  // namespace fascia
