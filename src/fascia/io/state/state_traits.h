#pragma once

#include <string>

#include <fascia/character/character.h>
#include <fascia/io/file/byte_stream.h>

namespace fascia {

// What a character must have in common with the one whose state a file holds.
void writeTraits(const Character& character, ByteWriter& out);
// Fails with all that differs from `character`.
void requireTraits(const Character& character, ByteReader& in);

}  // namespace fascia
