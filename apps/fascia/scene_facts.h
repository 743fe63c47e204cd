#pragma once

#include <fascia/world/stage_recording.h>

#include "facts.h"

namespace fascia {

// What `fascia info` tells of a scene, and of a performance of it.
void addScene(const Stage& stage, Facts& facts);
void addPerformance(const Stage& stage, const StageRecording& recording, Facts& facts);

}  // namespace fascia
