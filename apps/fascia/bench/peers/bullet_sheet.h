#pragma once

#include <memory>

#include "bench/sheet/sheet_scene.h"

namespace fascia {

// Bullet's position-based soft body: `substeps` world steps per frame, each with `iterations`
// passes over the links, which are as stiff as Bullet allows.
struct BulletSettings {
  int substeps = 5, iterations = 4;
};
std::unique_ptr<SheetSolver> makeBulletSheet(const SheetScene& scene,
                                             const BulletSettings& settings);

}  // namespace fascia
