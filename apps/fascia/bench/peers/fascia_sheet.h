#pragma once

#include <memory>

#include "bench/peers/sheet_scene.h"

namespace fascia {

// The sheet as a skin: the kernels, the contact and the default scheme of the skin module on an
// open grid.
struct FasciaSettings {
  double stiffness_N_per_m = 100;
};
// Writes how many steps a frame takes.
std::unique_ptr<SheetSolver> makeFasciaSheet(const SheetScene& scene,
                                             const FasciaSettings& settings, int& stepsPerFrame);

}  // namespace fascia
