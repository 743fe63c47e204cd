#pragma once

#include <vector>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// A moving figure without a surface: what a motion capture file holds, or a rig's joints with one
// of its motions. `motion.joints` are all the joints, in their order. Any up-axis and scale.
struct MotionFigure {
  std::vector<RigJoint> joints;
  SampledMotion motion;
};

// One of a model's own motions, to be put on another rig. The model's frames hold all joints.
MotionFigure figureOf(const RiggedModel& model, std::size_t motion);

// World frames of all joints in one frame of the motion.
void poseFigure(const MotionFigure& figure, std::size_t frame, std::vector<Transform>& world);

}  // namespace fascia
