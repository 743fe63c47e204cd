#include <fascia/io/rig_import/rig_import.h>

#include <fascia/base/error.h>
#include <fascia/io/rig_import/gltf/rig_gltf.h>
#include <fascia/io/rig_import/rig_to_gltf.h>

namespace fascia {
RiggedModel readRiggedModel(const std::string& path, const RigImportOptions& options) {
  Issue issue;
  issue.where.file = path;
  if (!(options.scale >= 1e-6 && options.scale <= 1e6)) {
    issue.message =
        "found the scale " + std::to_string(options.scale) + ", expected a number in [1e-6, 1e6]";
    throw Error(std::move(issue));
  }
  return rigFromGltf(readAsGltf(path), options);
}

}  // namespace fascia
