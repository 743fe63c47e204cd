#include <fascia/io/gltf/gltf_references.h>

#include <algorithm>
#include <array>

namespace fascia {
namespace {

void addMembers(Json* object, std::vector<Json*>& out) {
  if (!object || !object->is(Json::Kind::object)) return;
  for (Json::Member& member : object->object()) out.push_back(&member.value);
}

void addMember(Json* object, std::string_view key, std::vector<Json*>& out) {
  Json* member = object ? findMember(*object, key) : nullptr;
  if (member) out.push_back(member);
}

Json* memberOf(Json* object, std::string_view key) {
  return object ? findMember(*object, key) : nullptr;
}

template <class Visit>
void forEach(Json* list, const Visit& visit) {
  if (!list || !list->is(Json::Kind::list)) return;
  for (Json& item : list->list()) visit(&item);
}

// Attributes of nodes that are drawn many times.
void addInstances(Json* node, std::vector<Json*>& out) {
  Json* extension = memberOf(memberOf(node, "extensions"), "EXT_mesh_gpu_instancing");
  addMembers(memberOf(extension, "attributes"), out);
}

void check(const GltfPlace& root, const char* list, const std::vector<Json*>& references) {
  const int count = static_cast<int>(root[list].size());
  for (const Json* reference : references) {
    GltfPlace(reference, std::string("a reference to /") + list, root.file()).index(count);
  }
}

}  // namespace

std::vector<Json*> accessorReferences(Json& root) {
  std::vector<Json*> out;
  forEach(findMember(root, "meshes"), [&](Json* mesh) {
    forEach(memberOf(mesh, "primitives"), [&](Json* primitive) {
      addMembers(memberOf(primitive, "attributes"), out);
      addMember(primitive, "indices", out);
      forEach(memberOf(primitive, "targets"), [&](Json* target) { addMembers(target, out); });
    });
  });
  forEach(findMember(root, "skins"),
          [&](Json* skin) { addMember(skin, "inverseBindMatrices", out); });
  forEach(findMember(root, "animations"), [&](Json* animation) {
    forEach(memberOf(animation, "samplers"), [&](Json* sampler) {
      addMember(sampler, "input", out);
      addMember(sampler, "output", out);
    });
  });
  forEach(findMember(root, "nodes"), [&](Json* node) { addInstances(node, out); });
  return out;
}

std::vector<Json*> viewReferences(Json& root) {
  std::vector<Json*> out;
  forEach(findMember(root, "accessors"), [&](Json* accessor) {
    addMember(accessor, "bufferView", out);
    Json* sparse = memberOf(accessor, "sparse");
    addMember(memberOf(sparse, "indices"), "bufferView", out);
    addMember(memberOf(sparse, "values"), "bufferView", out);
  });
  forEach(findMember(root, "images"), [&](Json* image) { addMember(image, "bufferView", out); });
  return out;
}

void checkGltfReferences(const GltfPlace& root) {
  Json copy = *root.json();  // reading needs no more than const, finding references does
  check(root, "accessors", accessorReferences(copy));
  check(root, "bufferViews", viewReferences(copy));
}

bool hasUnknownReferences(const GltfPlace& root) {
  constexpr std::array kHarmless = {"KHR_materials_", "KHR_texture_",  "KHR_lights_", "KHR_node_",
                                    "KHR_xmp",        "EXT_texture_",  "EXT_lights_", "VRM",
                                    "MSFT_lod",       "MSFT_texture_", "ADOBE_"};
  constexpr std::array kKnown = {"KHR_mesh_quantization", "KHR_animation_pointer",
                                 "EXT_mesh_gpu_instancing"};
  const GltfPlace used = root["extensionsUsed"];
  for (std::size_t i = 0; i < used.size(); ++i) {
    const std::string name = used.at(i).text();
    const auto begins = [&](const char* prefix) { return name.starts_with(prefix); };
    if (std::none_of(kHarmless.begin(), kHarmless.end(), begins) &&
        std::find(kKnown.begin(), kKnown.end(), name) == kKnown.end()) {
      return true;
    }
  }
  return false;
}

}  // namespace fascia
