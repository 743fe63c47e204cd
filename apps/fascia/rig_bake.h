#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include <fascia/character/recording.h>
#include <fascia/io/rig_writer.h>

namespace fascia {

// How a simulated motion goes back into the file that a character's rig came from.
struct RigBakeOptions {
  std::string as;  // bones, morphs or cache; empty = bones
  int helpers = 20;
  int influences = 4;
  int targets = 16;

  void addTo(CLI::App& command);
};

// Throws Error if the options ask for a rig that the character does not have.
void checkRigBake(const Character& character, const RigBakeOptions& options);

RigBakeReport writeRigBake(const Character& character, const Recording& recording,
                           const RigBakeOptions& options, const std::string& path);

}  // namespace fascia
