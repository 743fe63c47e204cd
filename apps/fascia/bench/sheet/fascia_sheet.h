#pragma once

#include <memory>

#include "bench/sheet/sheet_scene.h"

namespace fascia {

// The sheet as a skin: the kernels, the contact and the two schemes of the skin module on an open
// grid.
struct FasciaSettings {
  static FasciaSettings skin(double stiffness_N_per_m) {
    constexpr double kShearShare = 0.4;  // as in the default skin
    return {stiffness_N_per_m, kShearShare * stiffness_N_per_m};
  }
  // Woven: hardly stretches, but shears easily.
  static FasciaSettings cloth(int stepsPerFrame) {
    constexpr double kCloth_N_per_m = 1e5, kClothShear_N_per_m = 20;
    return {kCloth_N_per_m, kClothShear_N_per_m, stepsPerFrame};
  }

  double stiffness_N_per_m = 100;
  double shear_N_per_m = 40;
  int clothSteps =
      0;  // per frame, of the scheme for cloth; 0: the leapfrog, with steps as it needs
};
// Writes how many steps a frame takes.
std::unique_ptr<SheetSolver> makeFasciaSheet(const SheetScene& scene,
                                             const FasciaSettings& settings, int& stepsPerFrame);

}  // namespace fascia
