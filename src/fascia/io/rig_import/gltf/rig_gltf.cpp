#include <fascia/io/rig_import/gltf/rig_gltf.h>

#include <filesystem>

#include <fascia/io/rig_import/gltf/rig_gltf_mesh.h>
#include <fascia/io/rig_import/gltf/rig_gltf_motion.h>
#include <fascia/io/rig_import/rig_import_surface.h>

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
