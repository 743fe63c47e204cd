#include <fascia/io/documents/character_file.h>

namespace fascia {

Character buildCharacter(const CharacterFile& file, const BuildOptions& options) {
  try {
    Character character(file.def, options);
    character.setWarnings(file.lines.locate(character.warnings()));
    return character;
  } catch (const Error& error) {
    throw Error(file.lines.locate(error.issues()));
  }
}

Character loadCharacter(const std::string& path, const BuildOptions& options) {
  return buildCharacter(readCharacterFile(path), options);
}

}  // namespace fascia
