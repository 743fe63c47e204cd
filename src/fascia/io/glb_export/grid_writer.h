#pragma once

#include <span>
#include <string>
#include <vector>

#include <fascia/baking/morph_basis.h>
#include <fascia/io/glb_export/gltf_writer.h>
#include <fascia/io/rig_export/rig_writer.h>

namespace fascia {

enum class GridWay { bones, morphs };

struct GridBakeOptions {
  GridWay way = GridWay::morphs;
  DecompositionOptions bones;  // its helper bones are for GridWay::bones
  MorphOptions morphs;
  const Texture* texture = nullptr;  // instead of the file that the character names
};

struct GridBakeReport {
  std::vector<BakeError> errors;  // per recording
  std::size_t added = 0;          // helper bones or morph targets
  std::size_t bytes = 0;
};

// A character whose skin lies on its solids (GridRig) as a small binary glTF: the skin has weights
// for the skeleton's joints and for helper bones, or for the joints and morph targets on top;
// ornaments are rigid nodes on their joints; every recording becomes an animation of its motion's
// name, and all share the weights, bones and targets. At rest it shows the rest posture. The files
// play by the core of glTF 2.0 alone. Errors are those of the written file, read back and played.
// Written whole or not at all. Throws Error.
GridBakeReport writeGridGlb(const Character& character,
                            std::span<const Recording* const> recordings,
                            const GridBakeOptions& options, const std::string& path);

}  // namespace fascia
