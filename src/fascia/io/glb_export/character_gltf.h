#pragma once

#include <string>
#include <vector>

#include <fascia/io/glb_export/gltf_writer.h>
#include <fascia/io/gltf/gltf_builder.h>

namespace fascia {

// Part of writeGlb(), for documents that hold more than one character: a character's nodes.
struct GltfCharacter {
  std::vector<int> roots;
  std::size_t framesKept = 0;
};
GltfCharacter addCharacter(const Character& character, const Recording& recording,
                           const GlbOptions& options, GltfBuilder& glb, Json& animation);

// An animation without tracks; a motion without a name is the rest posture.
Json emptyAnimation(const std::string& motion);

// The whole file with one scene of these root nodes, and those animations that move something.
std::string finishGlb(const std::string& name, const std::vector<int>& roots,
                      std::vector<Json> animations, GltfBuilder& glb);

}  // namespace fascia
