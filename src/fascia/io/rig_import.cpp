#include <fascia/io/rig_import.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include <fascia/base/error.h>
#include <fascia/io/makehuman_import.h>
#include <fascia/io/rig_gltf.h>

namespace fascia {
namespace {

std::string endingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

}  // namespace

RiggedModel readRiggedModel(const std::string& path, const RigImportOptions& options) {
  Issue issue;
  issue.where.file = path;
  if (!(options.scale >= 1e-6 && options.scale <= 1e6)) {
    issue.message =
        "found the scale " + std::to_string(options.scale) + ", expected a number in [1e-6, 1e6]";
    throw Error(std::move(issue));
  }
  const std::string ending = endingOf(path);
  if (ending == ".glb" || ending == ".gltf" || ending == ".vrm") {
    return rigFromGltf(GltfDocument::read(path), options);
  }
  if (isMakeHuman(path)) return readMakeHuman(path, options);
  issue.message = "has the ending \"" + ending + "\", which Fascia can't read a character from";
  issue.hint = "export it as .glb";
  throw Error(std::move(issue));
}

}  // namespace fascia
