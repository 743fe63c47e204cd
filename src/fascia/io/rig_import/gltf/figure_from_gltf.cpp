#include <fascia/io/rig_import/gltf/figure_from_gltf.h>

#include <algorithm>
#include <set>

#include <fascia/io/gltf/gltf_humanoid.h>
#include <fascia/io/rig_import/gltf/rig_from_gltf.h>

namespace fascia {
namespace {

bool hasSkinnedMesh(const GltfPlace& root) {
  const GltfPlace nodes = root["nodes"];
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (nodes.at(n)["mesh"] && nodes.at(n)["skin"]) return true;
  return false;
}

std::set<int> movedNodes(const GltfDocument& document) {
  const GltfPlace root = document.root(), animations = root["animations"];
  const int count = static_cast<int>(root["nodes"].size());
  std::set<int> nodes;
  for (std::size_t a = 0; a < animations.size(); ++a) {
    const GltfPlace channels = animations.at(a)["channels"];
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const GltfPlace target = channels.at(c)["target"];
      const std::string path = target["path"].textOr("");
      if (target["node"] && (path == "rotation" || path == "translation"))
        nodes.insert(target["node"].index(count));
    }
  }
  for (const HumanBone& bone : humanBonesOf(document.json()))
    if (bone.node < count) nodes.insert(bone.node);
  return nodes;
}

// A triangle that all of these nodes move, in a scene of the whole file: readers of rigs want one.
GltfDocument withStandIn(GltfDocument document, const std::set<int>& nodes) {
  constexpr float kCorners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  constexpr std::uint16_t kSlots[12] = {};
  constexpr float kWeights[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  Json attributes{Json::Object{}};
  attributes.set("POSITION", document.addFloats(kCorners, "VEC3", true));
  attributes.set("JOINTS_0", document.addJoints(kSlots));
  attributes.set("WEIGHTS_0", document.addFloats(kWeights, "VEC4"));
  Json primitive{Json::Object{}};
  primitive.set("attributes", std::move(attributes));
  const int mesh =
      document.add("meshes", Json::Object{{"primitives", Json::List{std::move(primitive)}}});
  const int skin = document.add("skins", Json::Object{{"joints", numberList(nodes)}});
  document.add("nodes", Json::Object{{"mesh", mesh}, {"skin", skin}});
  eraseMember(document.json(), "scenes");  // files without scenes show everything
  eraseMember(document.json(), "scene");
  return document;
}

}  // namespace

RiggedModel figureFromGltf(const GltfDocument& document) {
  if (hasSkinnedMesh(document.root())) return rigFromGltf(document);
  const std::set<int> nodes = movedNodes(document);
  if (nodes.empty()) document.root()["animations"].fail("there is no motion in the file");
  return rigFromGltf(withStandIn(document, nodes));
}

std::vector<std::string> saidOf(const GltfDocument& document, const RiggedModel& model) {
  std::vector<std::string> said(model.joints.size());
  bool any = false;
  for (const HumanBone& bone : humanBonesOf(document.json())) {
    const auto joint = std::ranges::find(model.joints, bone.node, &RigJoint::node);
    if (joint == model.joints.end()) continue;
    said[static_cast<std::size_t>(joint - model.joints.begin())] = bone.bone;
    any = true;
  }
  return any ? said : std::vector<std::string>{};
}

}  // namespace fascia
