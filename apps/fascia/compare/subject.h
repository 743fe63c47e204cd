#pragma once

#include "simulation_options.h"

namespace fascia {

// A character on a rig, recorded in motion.
struct Subject {
  Character character;
  Recording recording;
};

// From a character's file, a cache, or a rigged mesh, which gets flesh as 'fascia flesh' gives it.
// With `only_s` no other moment is kept. Throws Error for what has no rig, no skin or no motion.
Subject prepareSubject(const std::string& input, SimulationOptions& options,
                       std::optional<double> only_s, const Console& console);

}  // namespace fascia
