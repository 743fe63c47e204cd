#pragma once

#include <span>
#include <string>
#include <vector>

#include <fascia/io/rig_export/model_gltf.h>
#include <fascia/io/rig_export/rig_writer.h>
#include <fascia/io/rig_import/gltf/gltf_rig.h>

namespace fascia {

// How the importer brought a part's vertices from the file into the bind pose.
struct PartPlace {
  std::vector<Affine> toWorld;  // one for all, or one per vertex

  const Affine& of(std::size_t vertex) const {
    return toWorld[toWorld.size() > 1 ? vertex : std::size_t{0}];
  }
};

// The glTF that a model came from, opened again for editing, or one that was made out of the model.
struct RigSource {
  std::span<const RigClip> clips;  // at least one; all of this file
  const RigClip& clip;             // the first of them, for what they have in common
  GltfDocument document;
  double scale;     // from the document's lengths to metres
  GltfScene scene;  // as the file was; nodes that are added get later numbers
  GltfRig rig;
  std::vector<PartPlace> places;  // per part

  // Throws Error: the recording is not of this model, or the file is not the model's any more.
  static RigSource open(std::span<const RigClip> clips);

  Json& node(int index) { return document.item("nodes", index); }
  Json& primitive(const RigPart& part);
  // Meshes that several nodes show become one mesh per node, as each is deformed on its own.
  void separateMeshes();
  // A node that is at the top of the scene.
  int addTopNode(Json node);

  Affine unit() const;  // metres ← the file's lengths
  Affine bindOfJoint(int joint) const { return rig.bind_world[static_cast<std::size_t>(joint)]; }
};

// Frames of the model's points out of those of its vertices, without what the file's own morph
// targets make of them: players add that.
PointFrames pointFrames(const RigClip& clip);

// Motion of every joint from the bind pose to every frame.
BoneFrames boneFrames(const RigClip& clip);

}  // namespace fascia
