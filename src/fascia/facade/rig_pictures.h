#pragma once

#include <memory>
#include <string>
#include <vector>

#include <fascia/character/character.h>
#include <fascia/io/picture/texture.h>
#include <fascia/render/rig_surface.h>

namespace fascia {

// A picture made ready for drawing; null if there is none. Throws Error if it cannot be read, at
// the texture of the character file `owner` where that is known.
std::shared_ptr<const Pixels> toPixels(const Texture& texture, const std::string& owner = {});

// The decoded pictures of an imported character's materials; null if it has no rig. One that cannot
// be read is left out, and noted: the rest of the character is still worth seeing.
std::shared_ptr<const RigSurface> rigSurface(const Character& character,
                                             std::vector<std::string>* notes = nullptr);

}  // namespace fascia
