#include <fascia/character/flesh_character.h>
#include <fascia/fascia.h>
#include <fascia/io/documents/character_file.h>
#include <fascia/io/glb_export/gltf_writer.h>
#include <fascia/io/picture/image.h>
#include <fascia/io/rig_import/rig_import.h>

namespace fascia {

CharacterDef readCharacter(const std::string& path) {
  return readCharacterFile(path).def;
}

void writeCharacter(const CharacterDef& def, const std::string& path) {
  writeCharacterFile(def, path);
}

CharacterDef fleshRig(const std::string& path) {
  return fleshCharacter(std::make_shared<const RiggedModel>(readRiggedModel(path))).def;
}

void writeAnimation(const Character& character, const Recording& recording,
                    const std::string& path) {
  writeGlb(character, recording, path);
}

void writePicture(const Pixels& picture, const std::string& path) {
  writePng({picture.width, picture.height, picture.rgba}, path);
}

}  // namespace fascia
