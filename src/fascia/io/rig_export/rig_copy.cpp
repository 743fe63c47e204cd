#include <fascia/io/rig_export/rig_copy.h>

#include <fascia/io/rig_export/model_gltf.h>

namespace fascia {

double copyRig(const RiggedModel& model, double scale, const std::string& path) {
  const SourceDocument source = sourceDocumentOf(model, scale);
  source.document.writeGlb(path);
  return source.scale;
}

}  // namespace fascia
