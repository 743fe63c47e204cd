#pragma once

#include <memory>

#include <fascia/character/character.h>
#include <fascia/io/picture/texture.h>
#include <fascia/render/rig_surface.h>

#include "console.h"

namespace fascia {

// A picture made ready for drawing; null if there is none.
std::shared_ptr<const Pixels> toPixels(const Texture& texture);

// The decoded pictures of an imported character's materials; null if it has no rig. One that cannot
// be read is left out, and named: the rest of the character is still worth seeing.
std::shared_ptr<const RigSurface> rigSurface(const Character& character, const Console& console);

// The options of a simulation whose one moment is wanted: as far as that, and only its frame kept.
template <class RecordOptions>
void keepOnly(double time_s, double frameRate_hz, RecordOptions& record) {
  record.duration_s = std::max(time_s, 0.5 / frameRate_hz);
  record.start_s = time_s - 0.5 / frameRate_hz;
}

}  // namespace fascia
