#pragma once

#include <memory>
#include <vector>

#include <fascia/character/character.h>
#include <fascia/skin/grid/grid_skin.h>

#include "solvers/scheme.h"

namespace fascia {

// A run of a skin, frame by frame: where its points were, and what that cost.
struct Trajectory {
  std::vector<VectorArray> frames;  // positions at the end of each frame, storage order
  double cpu_s = 0;                 // processor time, all told
  double stepping_s = 0;            // of it in a Scheme: without posing and contact projection
  double steps = 0;
};

struct RunOptions {
  int motion = 0;
  int frames = 120;  // at kFrame_s
};
inline constexpr double kFrame_s = 1.0 / 60;

// From the settled skin `start`: with the integrator that the character was built with.
Trajectory runLibrary(const Character& character, const SkinState& start,
                      const RunOptions& options);
// The same with another scheme, `stepsPerFrame` rounded up to whole steps per contact interval.
Trajectory runScheme(const Character& character, const SkinState& start, const RunOptions& options,
                     Scheme& scheme, int stepsPerFrame);

// Distances between two runs over all points and frames.
struct Difference {
  double rms_m = 0, max_m = 0;
};
Difference difference(const GridLayout& layout, const Trajectory& a, const Trajectory& b);

}  // namespace fascia
