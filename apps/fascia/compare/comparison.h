#pragma once

#include <string>

#include "compare/sides.h"
#include "compare/survey.h"
#include "simulation_options.h"

namespace fascia {

struct CompareOptions {
  std::string input, output;
  std::string size, camera;  // empty: chosen
  std::string against = plainSkinnings().front();
  Worst worst = Worst::plain;
  double time_s = -1;        // negative: the worst moment
  double frame_rate_hz = 0;  // 0: 30, of a .gif 20
  int zooms = -1;            // negative: 3, of a film 1
  bool wipe = false, turntable = false, stand = false;
  SimulationOptions simulation;

  // With what depends on the format filled in.
  bool film() const;
  Size pictureSize() const;
  std::size_t places() const;
  double rate_hz() const;
};

// Simulates, looks for the worst, draws, writes, reports.
void compare(CompareOptions& options, const Console& console);

}  // namespace fascia
