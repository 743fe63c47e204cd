#pragma once

#include <memory>

#include "bench/peers/sheet_scene.h"

namespace fascia {

// The sheet as a skin: the kernels, the contact and the default scheme of the skin module on an
// open grid. Large sheets ride on a coarse one, as large skins do.
struct FasciaSettings {
  double stiffness_N_per_m = 100;
};
// How the sheet will be stepped, for the record.
struct FasciaSteps {
  int perFrame = 0;
  int coarseSide = 0;  // 0: it does not ride
  int coarsePerFrame = 0;
};
std::unique_ptr<SheetSolver> makeFasciaSheet(const SheetScene& scene,
                                             const FasciaSettings& settings, FasciaSteps& steps);

}  // namespace fascia
