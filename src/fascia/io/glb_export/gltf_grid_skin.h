#pragma once

#include <span>
#include <vector>

#include <fascia/baking/morph_basis.h>
#include <fascia/io/glb_export/grid_rig.h>
#include <fascia/io/gltf/gltf_builder.h>

namespace fascia {

// A grid's surface at rest with weights for bones, and morph targets.
struct GridSkinMesh {
  const GridRig& rig;
  std::span<const PointWeights> weights;  // per point; bones as the glTF's skin numbers them
  const MorphBasis& basis;
  std::vector<std::vector<Eigen::Vector3f>> turns;  // target, point: what is added to the normal
};

// Adds it; returns the mesh.
int addGridSkin(const GridSkinMesh& skin, int material, GltfBuilder& glb);

}  // namespace fascia
