#include <fascia/io/documents/character_file.h>

#include <fascia/io/documents/character_codecs.h>
#include <fascia/io/documents/document.h>
#include <fascia/io/file/file.h>
#include <fascia/io/picture/texture.h>
#include <fascia/io/rig_import/rig_file.h>

namespace fascia {

CharacterFile readCharacterText(std::string_view text, const std::string& file) {
  CharacterFile out;
  out.def = readDocument(text, kCharacterKind, *characterCodec(), file, out.lines);
  return out;
}

CharacterFile readCharacterFile(const std::string& path) {
  CharacterFile out = readCharacterText(readFile(path, JsonLimits{}.bytes), path);
  out.def.folder = folderOf(path);
  try {
    loadTexture(out.def);
    if (out.def.rig) out.def.rig->model = loadRig(out.def);
  } catch (const Error& error) {
    throw Error(out.lines.locate(error.issues()));
  }
  return out;
}

std::string characterText(const CharacterDef& def) {
  return documentText(kCharacterKind, characterCodec()->write(def));
}

void writeCharacterFile(const CharacterDef& def, const std::string& path) {
  writeFileWhole(path, characterText(def));
}

std::string characterSchema() {
  return documentSchema(kCharacterKind, "Fascia character file", characterCodec()->schema());
}

}  // namespace fascia
