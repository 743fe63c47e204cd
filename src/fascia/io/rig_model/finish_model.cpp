#include <fascia/io/rig_model/finish_model.h>

#include <filesystem>

#include <fascia/io/rig_model/simulated_surface.h>

namespace fascia {

void finishModel(const std::string& path, double scale, RiggedModel& model) {
  model.name = std::filesystem::path(path).stem().string();
  model.sourceFile = path;
  const auto joints = static_cast<int>(model.joints.size());
  for (int j = 0; j < joints; ++j) model.joints[static_cast<std::size_t>(j)].node = j;
  int mesh = 0;
  for (RigPart& part : model.parts) {
    if (part.name.empty()) part.name = "mesh " + std::to_string(mesh);
    part.node = joints + mesh, part.mesh = mesh, part.primitive = 0;
    ++mesh;
  }
  noteOddSize(scale, model);
}

}  // namespace fascia
