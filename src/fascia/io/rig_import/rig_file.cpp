#include <fascia/io/rig_import/rig_file.h>

#include <fascia/io/file/inside_folder.h>
#include <fascia/io/rig_import/rig_import.h>

namespace fascia {
namespace {

constexpr const char* kRigPointer = "/rig/file";

}  // namespace

std::shared_ptr<const RiggedModel> loadRig(const CharacterDef& def) {
  if (!def.rig) return nullptr;
  const std::string place = insideFolder(def.folder, def.rig->file, "the rig", kRigPointer);
  try {
    return std::make_shared<const RiggedModel>(
        readRiggedModel(place, RigImportOptions{.scale = def.rig->scale}));
  } catch (const Error& error) {
    // Told from the character's file; where in the rig each fault is goes into the message.
    std::vector<Issue> issues;
    for (const Issue& fault : error.issues()) {
      Issue issue;
      issue.where.pointer = kRigPointer;
      issue.message = "the rig " + fault.text();
      issues.push_back(std::move(issue));
    }
    throw Error(std::move(issues));
  }
}

}  // namespace fascia
