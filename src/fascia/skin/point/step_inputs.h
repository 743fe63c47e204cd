#pragma once

#include <fascia/base/aligned.h>
#include <fascia/skin/point/point_model.h>

namespace fascia {

// What has a say after every step of an interval.
class StepEnd {
 public:
  virtual ~StepEnd() = default;
  // time_s: since the interval's start.
  virtual void stepped(float time_s, VectorArray& position, VectorArray& velocity) = 0;
};

// What a step of the stabilised leapfrog reads besides the surface's own forces; shared by grids
// and meshes.
struct StepInputs {
  const PointModel* points;
  const StepCoefficients* step;
  const PointSurroundings* surroundings;
  const VectorArray* extraForce;  // N, added to the surface's; nullptr = none
  float gravity[3];               // m/s²
  StepEnd* stepEnd = nullptr;     // called after every step, and may change extraForce; or nullptr
};

}  // namespace fascia
