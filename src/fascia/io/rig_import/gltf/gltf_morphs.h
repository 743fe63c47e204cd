#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <fascia/io/rig_import/gltf/gltf_scene.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// Reads the morph targets of primitives: first of vertices, then, when the simulated surface is
// made, of its points. All of a node's targets become morphs, also those that move nothing: their
// numbers stay the file's.
class GltfMorphs {
 public:
  GltfMorphs(const GltfDocument& document, const GltfScene& scene, RiggedModel& model)
      : document_(document), scene_(scene), model_(model) {}

  // Of a primitive with targets; toWorld: what brings each of its vertices' directions into the
  // bind pose.
  void read(const RigPart& part, const GltfPlace& primitive,
            std::span<const Eigen::Matrix3f> toWorld);
  // Moves vertices to where the weights at rest have them, and readies movedAlike().
  void shapeRest(std::vector<Eigen::Vector3f>& positions_m);
  // Whether all morphs move two vertices the same way.
  bool movedAlike(std::uint32_t a, std::uint32_t b) const;
  // Gives the model its morphs, whose vertices have points by now.
  void finish();

 private:
  struct Move {
    std::uint32_t morph;
    Eigen::Vector3f displacement_m;
  };
  std::size_t morphsOf(int node);
  std::vector<Eigen::Vector3f> displacements(const GltfPlace& accessor, std::size_t count);
  std::string freshName(const GltfPlace& mesh, const GltfNode& node, std::size_t target) const;
  std::span<const Move> movesOf(std::uint32_t vertex) const {
    return {moves_.data() + firstMove_[vertex], moves_.data() + firstMove_[vertex + 1]};
  }

  const GltfDocument& document_;
  const GltfScene& scene_;
  RiggedModel& model_;
  std::vector<RigMorph> morphs_;        // of vertices, in their order
  std::vector<std::size_t> firstMove_;  // per vertex, one more at the end
  std::vector<Move> moves_;             // by vertex, then morph
  float alike_m_ = 0;
  std::size_t numbers_ = 0;  // that were decoded
  std::size_t misfits_ = 0, unsound_ = 0;
};

}  // namespace fascia
