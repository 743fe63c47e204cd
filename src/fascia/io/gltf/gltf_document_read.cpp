// Reading: the container (glTF 2.0, 4.4), the buffers, the extensions that must be understood.
#include <algorithm>
#include <array>

#include <fascia/io/file/byte_stream.h>
#include <fascia/io/file/file.h>
#include <fascia/io/file/inside_folder.h>
#include <fascia/io/gltf/data_uri.h>
#include <fascia/io/gltf/gltf_document.h>

namespace fascia {
namespace {

constexpr std::size_t kMostGltfBytes = std::size_t{2} << 30;  // of a file or of a buffer beside it
constexpr JsonLimits kLimits{std::size_t{1} << 29, 4'000'000, 64};
constexpr std::string_view kGlbMagic = "glTF";
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

struct Chunks {
  std::string_view json, binary;
};

Chunks glbChunks(std::string_view bytes, const std::string& path) {
  ByteReader reader(bytes, path);
  reader.take(kGlbMagic.size());
  const auto version = reader.value<std::uint32_t>();
  if (version != 2) reader.fail("is glTF version " + std::to_string(version) + ", expected 2");
  const auto length = reader.value<std::uint32_t>();
  if (length > bytes.size()) {
    reader.fail("is cut short: " + std::to_string(bytes.size()) + " of " + std::to_string(length) +
                " bytes");
  }
  Chunks chunks;
  bool first = true;
  while (reader.left() >= 8) {
    const auto size = reader.value<std::uint32_t>();
    const auto type = reader.value<std::uint32_t>();
    const std::string_view data = reader.take(size);
    if (first && type != kJsonChunk) reader.fail("has no JSON in its first chunk");
    if (first) chunks.json = data;
    if (type == kBinaryChunk && chunks.binary.empty()) chunks.binary = data;
    first = false;
  }
  if (first) reader.fail("is cut short");
  return chunks;
}

// Extensions that a reader of shapes, rigs and motions may require without loss, beyond those of
// the looks, which are kept as they are.
bool mayBeRequired(std::string_view name) {
  constexpr std::array kLooks = {"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_",
                                 "VRM"};
  constexpr std::array kShapes = {"KHR_mesh_quantization",   "KHR_draco_mesh_compression",
                                  "EXT_meshopt_compression", "KHR_animation_pointer",
                                  "KHR_node_visibility",     "MSFT_texture_dds"};
  const auto begins = [&](const char* prefix) { return name.starts_with(prefix); };
  return std::any_of(kLooks.begin(), kLooks.end(), begins) ||
         std::find(kShapes.begin(), kShapes.end(), name) != kShapes.end();
}

void checkRequiredExtensions(const GltfPlace& root) {
  const GltfPlace required = root["extensionsRequired"];
  for (std::size_t i = 0; i < required.size(); ++i) {
    const std::string name = required.at(i).text();
    if (mayBeRequired(name)) continue;
    required.at(i).fail("requires the extension " + jsonText(name) + ", which Fascia can't read",
                        "export the file without it");
  }
}

void checkVersion(const GltfPlace& root) {
  if (!root.json()->is(Json::Kind::object)) root.fail("is no glTF: expected an object");
  const GltfPlace version = root["asset"]["version"];
  if (!version) root.fail("is no glTF 2.0: it has no /asset/version");
  if (!version.text().starts_with("2.")) version.fail("found " + version.text() + ", expected 2.0");
}

}  // namespace

GltfDocument GltfDocument::read(const std::string& path) {
  return parse(readFile(path, kMostGltfBytes), path);
}

GltfDocument GltfDocument::parse(std::string_view bytes, const std::string& path) {
  GltfDocument document;
  document.path_ = path;
  Chunks chunks{bytes, {}};
  if (bytes.starts_with(kGlbMagic)) chunks = glbChunks(bytes, path);
  std::vector<Issue> issues;
  document.json_ = parseJson(chunks.json, kLimits, issues);
  for (Issue& issue : issues) issue.where.file = path;
  if (!issues.empty()) throw Error(std::move(issues));
  checkVersion(document.root());
  checkRequiredExtensions(document.root());
  document.notePictures();
  document.loadBuffers(chunks.binary);
  document.unpackCompressedViews();
  document.unpackCompressedMeshes();
  return document;
}

void GltfDocument::loadBuffers(std::string_view binaryChunk) {
  const GltfPlace buffers = root()["buffers"];
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const GltfPlace buffer = buffers.at(i), uri = buffer["uri"];
    const std::size_t length = buffer["byteLength"].count();
    Bytes shared = uri ? dataOf(uri.text(), uri) : std::make_shared<std::vector<std::uint8_t>>();
    if (!uri && i == 0) shared->assign(binaryChunk.begin(), binaryChunk.end());
    const std::vector<std::uint8_t>& bytes = *shared;
    buffers_.push_back(std::move(shared));
    // A buffer without any bytes only stands in for compressed data that are elsewhere.
    if (!bytes.empty() && bytes.size() < length) {
      buffer.fail(
          "found " + std::to_string(bytes.size()) + " bytes, expected " + std::to_string(length),
          "is the file cut short?");
    }
  }
}

GltfDocument::Bytes GltfDocument::dataOf(const std::string& uri, const GltfPlace& place) const {
  if (uri.starts_with("data:")) {
    auto bytes = std::make_shared<std::vector<std::uint8_t>>();
    if (!decodeDataUri(uri, *bytes)) place.fail("is no data URI in base64");
    return bytes;
  }
  const std::string name = decodePercents(uri);
  const std::size_t colon = name.find(':');
  if (colon != std::string::npos && colon < name.find('/')) {
    place.fail("leads out of the file's folder: " + jsonText(uri.substr(0, 80)),
               "put the file beside this one");
  }
  try {
    return fileBeside(insideFolder(folderOf(path_), name, "a part of the glTF", ""));
  } catch (const Error& error) {
    place.fail(error.issues().front().message, error.issues().front().hint);
  }
}

// Pictures are read when somebody asks for them; that they are part of the file is known before.
void GltfDocument::notePictures() const {
  const GltfPlace images = root()["images"];
  for (std::size_t i = 0; i < images.size(); ++i) {
    const GltfPlace uri = images.at(i)["uri"];
    if (!uri || !uri.json()->is(Json::Kind::text) || uri.text().starts_with("data:")) continue;
    const std::string folder = folderOf(path_);
    noteInput((folder.empty() ? "" : folder + "/") + decodePercents(uri.text()));
  }
}

// However often and under however many names it is asked for, a file is read once.
GltfDocument::Bytes GltfDocument::fileBeside(const std::string& name) const {
  const std::optional<FileId> id = fileIdOf(name);
  if (id && files_.contains(*id)) return files_[*id];
  const std::string text = readFile(name, kMostGltfBytes - file_bytes_);
  auto bytes = std::make_shared<std::vector<std::uint8_t>>(text.begin(), text.end());
  file_bytes_ += bytes->size();
  if (id) files_[*id] = bytes;
  return bytes;
}

}  // namespace fascia
