#include <fascia/io/rig_import/gltf/rig_from_gltf.h>

#include <filesystem>

#include <fascia/io/rig_import/gltf/gltf_materials.h>
#include <fascia/io/rig_import/gltf/gltf_meshes.h>
#include <fascia/io/rig_import/gltf/gltf_motions.h>
#include <fascia/io/rig_model/simulated_surface.h>

namespace fascia {

RiggedModel rigFromGltf(const GltfDocument& document, const RigImportOptions& options) {
  RiggedModel model;
  model.sourceFile = document.path();
  model.name = std::filesystem::path(document.path()).stem().string();
  const GltfScene scene = GltfScene::of(document, options.scale, model.notes);
  const GltfRig rig = GltfRig::of(document, scene, model);
  readGltfMaterials(document, model);
  readGltfMeshes(document, scene, rig, model);
  readGltfMotions(document, scene, rig, model);
  noteOddSize(options.scale, model);
  return model;
}

}  // namespace fascia
