#pragma once

#include <memory>

#include <fascia/facade/rig_pictures.h>

#include "console.h"

namespace fascia {

// The same, telling a person what is left out.
std::shared_ptr<const RigSurface> rigSurface(const Character& character, const Console& console);

// The options of a simulation whose one moment is wanted: as far as that, and only its frame kept.
template <class RecordOptions>
void keepOnly(double time_s, double frameRate_hz, RecordOptions& record) {
  record.duration_s = std::max(time_s, 0.5 / frameRate_hz);
  record.start_s = time_s - 0.5 / frameRate_hz;
}

}  // namespace fascia
