#pragma once

#include <string>

#include <fascia/character/character_def.h>
#include <fascia/io/picture/image.h>

namespace fascia {

// An encoded picture: the bytes of a PNG or JPEG file.
struct Texture {
  std::string bytes;  // empty = the skin has none
  std::string name;   // what messages call it; may be empty
  bool empty() const { return bytes.empty(); }
  const char* mimeType() const;
};

// The skin's texture, found from the character's folder. Throws Error if the name leads out of that
// folder (absolute, "..", links), if nothing is there, or if it is no picture or too large a one:
// character files come
// from strangers and must not read a person's other files. Empty if the skin names no texture.
Texture loadTexture(const CharacterDef& def);

}  // namespace fascia
