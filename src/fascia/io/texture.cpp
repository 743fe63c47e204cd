#include <fascia/io/texture.h>

#include <algorithm>
#include <filesystem>

#include <fascia/base/error.h>
#include <fascia/io/file.h>

namespace fascia {
namespace {

constexpr const char* kPointer = "/skin/texture";
constexpr std::size_t kMaxBytes = 64u << 20;

[[noreturn]] void fail(const std::string& message, const std::string& hint = {}) {
  Issue issue;
  issue.where.pointer = kPointer;
  issue.message = message;
  issue.hint = hint;
  throw Error(std::move(issue));
}

// The real place of `name`, links followed, which must lie inside the real folder.
std::filesystem::path insideFolder(const std::string& folder, const std::string& name) {
  namespace fs = std::filesystem;
  const fs::path relative(name);
  const bool climbs = std::find(relative.begin(), relative.end(), "..") != relative.end();
  if (relative.is_absolute() || climbs || name.find('\\') != std::string::npos ||
      name.find('\0') != std::string::npos) {
    fail("the texture must be named by a path inside the character's folder", "e.g. \"skin.png\"");
  }
  std::error_code error;
  const fs::path root = fs::canonical(folder.empty() ? "." : folder, error);
  const fs::path place = error ? fs::path() : fs::canonical(root / relative, error);
  if (error) fail("the texture is missing: " + (fs::path(folder) / relative).string());
  const auto [rootEnd, rest] = std::mismatch(root.begin(), root.end(), place.begin(), place.end());
  if (rootEnd != root.end()) fail("the texture is a link that leads out of the character's folder");
  return place;
}

}  // namespace

const char* Texture::mimeType() const {
  return imageFormat(bytes) == ImageFormat::jpeg ? "image/jpeg" : "image/png";
}

Texture loadTexture(const CharacterDef& def) {
  if (!def.skin || def.skin->texture.empty()) return {};
  const std::string& name = def.skin->texture;
  Texture texture;
  try {
    texture.bytes = readFile(insideFolder(def.folder, name).string(), kMaxBytes);
  } catch (const Error& error) {
    const Issue& issue = error.issues().front();
    if (!issue.where.pointer.empty()) throw;
    fail("the texture " + issue.text());
  }
  if (imageFormat(texture.bytes) == ImageFormat::unknown) {
    fail("the texture is neither a PNG nor a JPEG: " + name);
  }
  return texture;
}

}  // namespace fascia
