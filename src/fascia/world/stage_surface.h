#pragma once

#include <fascia/world/stage_recording.h>

namespace fascia {

// All surfaces of a performance as one mesh whose positions change: bodies in the order of the
// scene, then their ornaments, body by body, then the characters' skins. For point caches.
Recording surfaceRecording(const Stage& stage, const StageRecording& recording);

}  // namespace fascia
