#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "simulation_options.h"

namespace fascia {

// What every benchmark of the sheet can be told.
struct SheetOptions {
  std::vector<int> points = {1024, 10000, 100000};
  int frames = 180;
};

inline CLI::Option* addNumbers(CLI::App& command, const std::string& name, std::vector<int>& values,
                               const std::string& help, double low, double high) {
  return command.add_option(name, values, help)
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST")
      ->check(numberIn(low, high));
}

inline void addSheetOptions(CLI::App& command, SheetOptions& options) {
  addNumbers(command, "--points", options.points, "Points (default: 1024,10000,100000)", 64, 4e6);
  command.add_option("--frames", options.frames, "Frames that are measured (default: 180)")
      ->type_name("N")
      ->check(numberIn(12, 1e5));
}

}  // namespace fascia
