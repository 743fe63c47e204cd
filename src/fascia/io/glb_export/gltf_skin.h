#pragma once

#include <vector>

#include <fascia/character/recording.h>
#include <fascia/io/gltf/glb_builder.h>
#include <fascia/io/picture/texture.h>

namespace fascia {

struct GltfAnimation {
  GlbBuilder::Json samplers = GlbBuilder::Json::array();
  GlbBuilder::Json channels = GlbBuilder::Json::array();

  void add(std::size_t times, std::size_t values, std::size_t node, const char* path);
};

// The skin's colour or picture; returns the material.
std::size_t addSkinMaterial(const SkinDef& def, const Texture& texture, GlbBuilder& glb);

// Adds the skin's mesh and material; returns the mesh. kept: indices of the frames that became the
// base (the first) and the morph targets (the others).
std::size_t addSkinMesh(const SkinDef& def, const Recording& recording, const Texture& texture,
                        double tolerance_m, GlbBuilder& glb, std::vector<std::size_t>& kept);

// Cross-fades from each kept frame to the next.
void addSkinAnimation(const Recording& recording, const std::vector<std::size_t>& kept,
                      std::size_t node, GlbBuilder& glb, GltfAnimation& animation);

// A primitive of a mesh with normals, of this material.
GlbBuilder::Json addPrimitive(const TriangleMesh& mesh, std::size_t material, GlbBuilder& glb);

// A colour as glTF wants it: linear, with alpha.
GlbBuilder::Json linearColor(float r, float g, float b);

}  // namespace fascia
