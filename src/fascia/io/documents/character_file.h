#pragma once

#include <string>
#include <string_view>

#include <fascia/character/character.h>
#include <fascia/io/json/line_index.h>

namespace fascia {

// A character file as read: the definition, and where its parts stand.
struct CharacterFile {
  CharacterDef def;
  LineIndex lines;  // gives faults that building finds a file and a line
};

// Reads a *.fascia.json, and the rig that it names. Throws Error with every fault at once: file,
// line, JSON pointer. The texture's presence is checked here; what only building can know (cycles,
// names) is not.
CharacterFile readCharacterFile(const std::string& path);
// The same from memory; `file` is what messages call it. def.folder stays empty, and texture and
// rig are not looked for.
CharacterFile readCharacterText(std::string_view text, const std::string& file = {});

// Reads and builds: faults of both kinds carry file and line.
Character loadCharacter(const std::string& path, const BuildOptions& options = {});
Character buildCharacter(const CharacterFile& file, const BuildOptions& options = {});

// The file's text. What equals its default is left out; reading it back gives the same definition
// to the last bit (solid parameters at their standard value may come back left out).
// Throws Error if the definition holds NaN or infinities.
std::string characterText(const CharacterDef& def);
void writeCharacterFile(const CharacterDef& def, const std::string& path);

// The published JSON Schema (draft-07), made from the same tables that read and write.
std::string characterSchema();

}  // namespace fascia
