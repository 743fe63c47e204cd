#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fascia/character/character_def.h>
#include <fascia/rig/rigged_model.h>

#include "console.h"

namespace fascia {

// What a file gives: a rig, and a character if it is one.
struct Entrant {
  std::string name;  // the file's
  std::shared_ptr<const RiggedModel> model;
  std::optional<CharacterDef> character;
};
Entrant readEntrant(const std::string& path);

// The motions that a person wants to see: names of the rig's own; "all" of them, or "none"; motion
// capture files (see motion_file.h), which are put onto the rig. Nothing wanted: a walk, or else
// the first. What cannot be shown is added to the issues.
std::vector<SampledMotion> findMotions(const RiggedModel& model,
                                       const std::vector<std::string>& wanted,
                                       const Console& console, std::vector<Issue>& issues);

}  // namespace fascia
