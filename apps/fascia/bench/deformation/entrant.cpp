#include "bench/deformation/entrant.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include <fascia/base/suggest.h>
#include <fascia/io/documents/character_file.h>
#include <fascia/io/rig_import/rig_file.h>
#include <fascia/io/rig_import/rig_import.h>

#include "outputs.h"
#include "report_map.h"

namespace fascia {
namespace {

const SampledMotion* named(const RiggedModel& model, const std::string& name) {
  const auto found = std::find_if(model.motions.begin(), model.motions.end(),
                                  [&](const SampledMotion& m) { return m.name == name; });
  return found == model.motions.end() ? nullptr : &*found;
}

bool isWalk(const SampledMotion& motion) {
  std::string lower = motion.name;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower.find("walk") != std::string::npos;
}

Issue unknown(const RiggedModel& model, const std::string& name) {
  std::vector<std::string> names;
  std::string all;
  for (const SampledMotion& motion : model.motions) {
    names.push_back(motion.name);
    all += (all.empty() ? "" : ", ") + motion.name;
  }
  Issue issue;
  issue.message =
      "no motion is named " + quotedName(name) + "; there are: " + (all.empty() ? "none" : all);
  issue.hint = didYouMean(name, names);
  return issue;
}

SampledMotion fromFile(const std::string& path, const RiggedModel& model, const Console& console) {
  MotionFile file = readMotionFile(path, model, "");
  SampledMotion motion = ontoRig(file, model);
  reportMap(file, model, console);
  return motion;
}

}  // namespace

Entrant readEntrant(const std::string& path) {
  const std::string name = std::filesystem::path(path).filename().string();
  const bool isCharacter = path.ends_with(".fascia.json");
  if (!isCharacter)
    return {name, std::make_shared<const RiggedModel>(readRiggedModel(path)), std::nullopt};
  CharacterFile file = readCharacterFile(path);
  if (!file.def.rig) {
    Issue issue;
    issue.where.file = path;
    issue.message = "has no rig, and so nothing that other ways of skinning could deform";
    issue.hint = "make a character of a rigged file with 'fascia flesh'";
    throw Error(issue);
  }
  if (!file.def.rig->model) file.def.rig->model = loadRig(file.def);
  std::shared_ptr<const RiggedModel> model = file.def.rig->model;
  return {name, std::move(model), std::move(file.def)};
}

std::vector<SampledMotion> findMotions(const RiggedModel& model,
                                       const std::vector<std::string>& wanted,
                                       const Console& console, std::vector<Issue>& issues) {
  std::vector<SampledMotion> motions;
  if (wanted.empty() && !model.motions.empty()) {
    const auto walk = std::find_if(model.motions.begin(), model.motions.end(), isWalk);
    motions.push_back(walk == model.motions.end() ? model.motions.front() : *walk);
  }
  for (const std::string& name : wanted) {
    if (const SampledMotion* motion = named(model, name)) {
      motions.push_back(*motion);
    } else if (name == "all") {
      motions.insert(motions.end(), model.motions.begin(), model.motions.end());
    } else if (isMotionFile(name)) {
      try {
        motions.push_back(fromFile(name, model, console));
      } catch (const Error& error) {
        issues.insert(issues.end(), error.issues().begin(), error.issues().end());
      }
    } else if (name != "none") {
      issues.push_back(unknown(model, name));
    }
  }
  return motions;
}

}  // namespace fascia
