#pragma once

#include <string>
#include <vector>

#include <fascia/io/rig_import/gltf/gltf_scene.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

// One skin of the file, ready to place vertices in the bind pose.
struct GltfSkin {
  bool used = false;
  std::vector<int> joint;             // of the model, per joint of the skin
  std::vector<Affine> toWorld;        // per joint of the skin: mesh space -> bind pose
  Affine whole = Affine::Identity();  // the same for all, where `rigid`
  bool rigid = false;                 // all of toWorld are `whole`
};

// The joints of all skins that are shown, merged by node; after them a joint for each mesh without
// a skin that animations move otherwise than the joint which would carry it.
struct GltfRig {
  std::vector<GltfSkin> skins;
  std::vector<int> nodeOfJoint;    // -1: the made-up root
  std::vector<int> jointOfNode;    // the node's own joint; -1: none
  std::vector<int> carrierOfNode;  // its own joint or its nearest ancestor's; -1: none
  std::vector<Affine> bind_world;  // per joint, with the scale and shear of its node
  std::size_t skeletonCount = 0;   // joints before those of meshes that move by themselves

  // Bind poses: for each skin the inverse bind matrices say where its joints are relative to its
  // mesh; the place of the mesh in the world is the one that brings most joints to their nodes'
  // places. The first skin (in the order of nodes) decides for joints that several skins move; the
  // meshes of others that disagree are bent to it. Adds the model's joints and notes.
  static GltfRig of(const GltfDocument& document, const GltfScene& scene, RiggedModel& model);
};

}  // namespace fascia
