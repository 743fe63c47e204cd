#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include <fascia/character/character.h>

#include "takes.h"

namespace fascia {

// Files that a simulation goes on from, and that it can be gone on from.
struct StateFiles {
  std::string from, save;  // empty = none

  void addTo(CLI::App& command);
  bool any() const { return !from.empty() || !save.empty(); }
};

// A state belongs to a single motion, and to the motion as it is: no cycle is made of it. Throws
// Error if another thing was asked for.
void requireOnePlainMotion(const StateFiles& states, TakeOptions& takes);
void requireOneTake(const StateFiles& states, const Cast& cast);

// The state to go on from; none if no file is named. Throws Error if it cannot be, or if there is
// nothing left of the motion.
std::optional<CharacterState> stateToGoOnFrom(const StateFiles& states, const Cast& cast,
                                              const SimulationOptions& options);

}  // namespace fascia
