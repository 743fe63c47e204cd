#pragma once

#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <fascia/character/recording.h>
#include <fascia/io/rig_export/rig_writer.h>

#include "console.h"
#include "takes.h"

namespace fascia {

// Helpers that come by themselves stop here: more are no bother for a player, but for people.
inline constexpr int kMostHelpers = 128;

// How a simulated motion goes back into the file that a character's rig came from.
struct RigBakeOptions {
  std::string as;  // bones, morphs or cache; empty = bones, of a skin on a grid morphs
  int helpers = 20;
  double tolerance_percent = 0.2;  // of the height, RMS; 0 = `helpers` and no more
  int influences = 4;
  int targets = 16;
  std::string springs;  // keep or replace; empty = keep

  void addTo(CLI::App& command);
  // Those of the options above that were given, and the ways they belong to ("" = any).
  struct Given {
    std::string option, way;
  };
  std::vector<Given> given() const;

 private:
  const CLI::App* command_ = nullptr;
};

// Throws Error if the options ask for a skin that the character does not have, or for what none of
// the outputs is.
void checkRigBake(const Character& character, const RigBakeOptions& options,
                  const std::vector<std::string>& outputs);

// All files that an output becomes.
std::vector<std::string> filesOf(const Character& character, const RigBakeOptions& options,
                                 const std::string& output);

// All motions into one file; as a cache, only one.
RigBakeReport writeRigBake(const CharacterDef& def, std::span<const Shot> shots,
                           const RigBakeOptions& options, const std::string& path,
                           const Console& console);

// Says how faithful a bake is, for a person; for a machine the same.
Json describe(const RigBakeReport& report, const RigBakeOptions& options, const RiggedModel& rig,
              const std::string& path, const Console& console);

}  // namespace fascia
