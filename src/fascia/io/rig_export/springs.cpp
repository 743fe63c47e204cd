#include <fascia/io/rig_export/springs.h>

#include <fascia/base/index.h>
#include <fascia/io/gltf/gltf_humanoid.h>
#include <fascia/io/rig_import/rig_import.h>

namespace fascia {
namespace {

// Per node: a joint of the rig with a share in the skin.
std::vector<bool> skinnedNodes(const RigSource& source) {
  std::vector<bool> nodes(source.scene.nodes.size(), false);
  for (const PointWeights& w : source.clip.model.weights) {
    for (std::size_t i = 0; i < PointWeights::kMost && w.weight[i] > 0; ++i) {
      const int node = source.rig.nodeOfJoint[w.joint[i]];
      if (node >= 0) nodes[at(node)] = true;
    }
  }
  return nodes;
}

}  // namespace

std::vector<std::string> settleSprings(RigSource& source, const RigFileOptions& options) {
  Json& root = source.document.json();
  const std::size_t before = springCount(root);
  if (before == 0) return {};
  const std::size_t gone = options.replaceSprings ? eraseSprings(root, skinnedNodes(source)) : 0;
  std::vector<std::string> notes;
  if (gone > 0) notes.push_back(std::to_string(gone) + " swinging chains are replaced: taken out");
  if (before > gone)
    notes.push_back(std::to_string(before - gone) +
                    " swinging chains are kept: players swing them on top of what was baked");
  return notes;
}

bool isVrm(const RiggedModel& model) {
  return isGltfFile(model.sourceFile) && isVrm(GltfDocument::read(model.sourceFile).json());
}

}  // namespace fascia
