#pragma once

#include <optional>

#include <fascia/rig/rigged_model.h>

namespace fascia {

// A motion that ends in the pose that it begins with, perhaps in another place: a walk.
struct MotionCycle {
  Vec3 travel_m = Vec3::Zero();  // of the whole figure, in a period
  // After which it begins again: the motion's duration, or a frame more if the last pose leads to
  // the first as every pose does to the next. Exporters leave the doubled pose out at times.
  double period_s = 0;
};

// The cycle that one of the model's motions is; none: it ends in another pose. Joints that neither
// carry skin nor lead to such may be anywhere.
std::optional<MotionCycle> cycleOf(const RiggedModel& model, int motion);

// The motion for two periods, the second time from where the first has got to.
SampledMotion playedTwice(const RiggedModel& model, int motion, const MotionCycle& cycle);

}  // namespace fascia
