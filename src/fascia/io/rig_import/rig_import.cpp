#include <fascia/io/rig_import/rig_import.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <fascia/base/error.h>
#include <fascia/io/rig_import/assimp/assimp_import.h>
#include <fascia/io/rig_import/gltf/rig_from_gltf.h>
#include <fascia/io/rig_import/makehuman/makehuman_import.h>

namespace fascia {
namespace {

std::string endingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

[[noreturn]] void refuse(const std::string& path, const std::string& message,
                         const std::string& hint = {}) {
  Issue issue;
  issue.where.file = path;
  issue.message = message;
  issue.hint = hint;
  throw Error(std::move(issue));
}

}  // namespace

bool isGltfFile(const std::string& path) {
  const std::string ending = endingOf(path);
  return ending == ".glb" || ending == ".gltf" || ending == ".vrm";
}

RiggedModel readRiggedModel(const std::string& path, const RigImportOptions& options) {
  if (!(options.scale >= 1e-6 && options.scale <= 1e6))
    refuse(path, "found the scale " + std::to_string(options.scale) +
                     ", expected a number in [1e-6, 1e6]");
  if (isGltfFile(path)) return rigFromGltf(GltfDocument::read(path), options);
  if (isMakeHuman(path)) return readMakeHuman(path, options);
  const std::string ending = endingOf(path);
  if (isAssimpEnding(ending)) return readWithAssimp(path, options);
  refuse(path, "has the ending \"" + ending + "\", which Fascia can't read a character from",
         "export it as .glb");
}

}  // namespace fascia
