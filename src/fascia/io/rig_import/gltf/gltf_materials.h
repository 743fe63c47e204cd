#pragma once

#include <fascia/io/gltf/gltf_document.h>
#include <fascia/rig/rigged_model.h>

namespace fascia {

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
