#pragma once

#include <fascia/io/motion/motion_file.h>

#include "console.h"

namespace fascia {

// A line about the map for a person; every pair and note with --verbose.
void reportMap(const MotionFile& file, const RiggedModel& rig, const Console& console);

}  // namespace fascia
