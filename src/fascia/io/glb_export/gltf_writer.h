#pragma once

#include <cstddef>
#include <string>

#include <fascia/character/recording.h>
#include <fascia/io/picture/texture.h>

namespace fascia {

struct GlbOptions {
  // A frame between two kept ones may differ from their blend by this much, at any vertex. 0 keeps
  // every frame; 0.2 mm cannot be seen and drops most frames of a calm motion.
  double tolerance_m = 2e-4;
  bool ornaments = true;
  bool solids = false;               // the flesh too, as rigid meshes on their joints
  int solidDetail = 32;              // segments around a solid
  const Texture* texture = nullptr;  // instead of the file that the character names
};

struct GlbReport {
  std::size_t framesKept = 0;  // of recording.frames
  std::size_t bytes = 0;
};

// Binary glTF 2.0 (Khronos): the skin with uvs, normals and a baked animation by morph targets (one
// per kept frame, sparse, blended linearly), the skeleton as animated nodes, the ornaments on their
// joints. Written whole or not at all. Throws Error.
GlbReport writeGlb(const Character& character, const Recording& recording, const std::string& path,
                   const GlbOptions& options = {});

}  // namespace fascia
