#pragma once

#include <fascia/io/rig_import/gltf/rig_gltf_joints.h>

namespace fascia {

// Reads the primitives of all meshes that are shown into the model: vertices, drawnTriangles, parts
// and, through buildSimulatedSurface, the simulated surface. Everything is placed in the bind pose.
void readGltfMeshes(const GltfDocument& document, const GltfScene& scene, const GltfRig& rig,
                    RiggedModel& model);

// Fills the model's materials; pictures are taken along as they are, if they are PNG or JPEG.
void readGltfMaterials(const GltfDocument& document, RiggedModel& model);

// Where the base colour picture is looked up.
struct GltfTextureUse {
  int texture = -1;  // -1: none
  int uvSet = 0;
  Eigen::Matrix<float, 2, 3> uvTransform = Eigen::Matrix<float, 2, 3>::Identity();
};
GltfTextureUse baseTextureOf(const GltfDocument& document, int material);

}  // namespace fascia
