#include <fascia/io/picture/texture.h>

#include <fascia/io/file/file.h>
#include <fascia/io/file/inside_folder.h>

namespace fascia {
namespace {

constexpr const char* kTexturePointer = "/skin/texture";
constexpr std::size_t kMaxBytes = 64u << 20;

}  // namespace

const char* Texture::mimeType() const {
  return imageFormat(bytes) == ImageFormat::jpeg ? "image/jpeg" : "image/png";
}

Texture loadTexture(const CharacterDef& def) {
  if (!def.skin || def.skin->texture.empty()) return {};
  const std::string& name = def.skin->texture;
  const std::string place = insideFolder(def.folder, name, "the texture", kTexturePointer);
  Texture texture;
  try {
    texture.bytes = readFile(place, kMaxBytes);
    checkPicture(texture.bytes, name);
  } catch (const Error& error) {
    throw errorAt(kTexturePointer, "the texture " + error.issues().front().text());
  }
  texture.name = name;
  return texture;
}

}  // namespace fascia
