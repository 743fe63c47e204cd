#pragma once

#include <string>
#include <vector>

#include "console.h"
#include "simulation_options.h"

namespace fascia {

// What 'fascia bake' does with a scene.
struct SceneBake {
  std::string scene;
  std::vector<std::string> outputs;
  std::string stats;
  SimulationOptions simulation;
};
void bakeScene(const SceneBake& bake, const Console& console);

}  // namespace fascia
