#include <fascia/io/documents/character_file.h>

namespace fascia {

Character buildCharacter(const CharacterFile& file, const BuildOptions& options) {
  try {
    return Character(file.def, options);
  } catch (const Error& error) {
    throw Error(file.lines.locate(error.issues()));
  }
}

Character loadCharacter(const std::string& path, const BuildOptions& options) {
  return buildCharacter(readCharacterFile(path), options);
}

}  // namespace fascia
