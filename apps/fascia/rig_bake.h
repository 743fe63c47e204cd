#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <fascia/character/recording.h>
#include <fascia/io/rig_writer.h>

#include "console.h"

namespace fascia {

// How a simulated motion goes back into the file that a character's rig came from.
struct RigBakeOptions {
  std::string as;  // bones, morphs or cache; empty = bones
  int helpers = 20;
  int influences = 4;
  int targets = 16;

  void addTo(CLI::App& command);
  // Those of the options above that were given, and the ways they belong to ("" = any).
  struct Given {
    std::string option, way;
  };
  std::vector<Given> given() const;

 private:
  const CLI::App* command_ = nullptr;
};

// Throws Error if the options ask for a rig that the character does not have, or for what none of
// the outputs is.
void checkRigBake(const Character& character, const RigBakeOptions& options,
                  const std::vector<std::string>& outputs);

// All files that an output becomes.
std::vector<std::string> filesOf(const Character& character, const RigBakeOptions& options,
                                 const std::string& output);

RigBakeReport writeRigBake(const Character& character, const Recording& recording,
                           const RigBakeOptions& options, const std::string& path,
                           const Console& console);

}  // namespace fascia
