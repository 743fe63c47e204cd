#pragma once

#include <string>
#include <vector>

#include <fascia/character/recording.h>
#include <fascia/io/gltf/gltf_builder.h>
#include <fascia/io/picture/texture.h>

namespace fascia {

// The skin's colour or picture; returns the material.
int addSkinMaterial(const SkinDef& def, const Texture& texture, GltfBuilder& glb);
// A material of one colour.
int addMaterial(const Color& color, double roughness, GltfBuilder& glb);

// Adds the skin's mesh and material; returns the mesh. kept: indices of the frames that became the
// base (the first) and the morph targets (the others).
int addSkinMesh(const SkinDef& def, const Recording& recording, const Texture& texture,
                double tolerance_m, GltfBuilder& glb, std::vector<std::size_t>& kept);

// Cross-fades from each kept frame to the next.
void addSkinAnimation(const Recording& recording, const std::vector<std::size_t>& kept, int node,
                      GltfBuilder& glb, Json& animation);

// A primitive of a mesh with normals, of this material.
Json addPrimitive(const TriangleMesh& mesh, int material, GltfBuilder& glb);

// The morph targets of a mesh of one primitive.
struct MorphTargets {
  Json::List targets, names;
  std::vector<float> weights;  // at rest

  void add(Json target, const std::string& name, float weight = 0);
};
Json morphTarget(int positions, int normals);  // of accessors

// Returns the mesh.
int addMesh(const std::string& name, Json primitive, MorphTargets targets, GltfBuilder& glb);

}  // namespace fascia
