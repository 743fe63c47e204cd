#pragma once

#include <fascia/base/aligned.h>
#include <fascia/skin/point/point_model.h>

namespace fascia {

// What a step of the stabilised leapfrog reads besides the surface's own forces; shared by grids
// and meshes.
struct StepInputs {
  const PointModel* points;
  const StepCoefficients* step;
  const PointSurroundings* surroundings;
  const VectorArray* extraForce;  // N, added to the surface's; nullptr = none
  float gravity[3];               // m/s²
};

}  // namespace fascia
