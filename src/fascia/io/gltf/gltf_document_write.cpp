// Writing one .glb: what is no longer used is left out, everything else is packed into one buffer.
#include <algorithm>
#include <limits>
#include <map>

#include <fascia/io/file/byte_stream.h>
#include <fascia/io/file/file.h>
#include <fascia/io/gltf/gltf_document.h>
#include <fascia/io/gltf/gltf_references.h>

namespace fascia {
namespace {

constexpr std::size_t kMostGlbBytes = std::numeric_limits<std::uint32_t>::max();  // of a .glb

// Keeps the entries of a list that are referred to; renumbers the references.
void dropUnused(Json& root, const char* list, const std::vector<Json*>& references) {
  Json* entries = findMember(root, list);
  if (!entries || !entries->is(Json::Kind::list)) return;
  std::vector<int> renumbered(entries->list().size(), -1);
  for (const Json* reference : references) {
    renumbered[static_cast<std::size_t>(reference->number())] = 0;
  }
  Json::List kept;
  for (std::size_t i = 0; i < renumbered.size(); ++i) {
    if (renumbered[i] < 0) continue;
    renumbered[i] = static_cast<int>(kept.size());
    kept.push_back(std::move(entries->list()[i]));
  }
  for (Json* reference : references) {
    *reference = Json(renumbered[static_cast<std::size_t>(reference->number())]);
  }
  if (kept.empty()) {
    eraseMember(root, list);
  } else {
    *entries = Json(std::move(kept));
  }
}

const char* mimeTypeOf(const std::vector<std::uint8_t>& bytes) {
  const std::string_view begin(reinterpret_cast<const char*>(bytes.data()),
                               std::min<std::size_t>(bytes.size(), 12));
  if (begin.starts_with("\x89PNG")) return "image/png";
  if (begin.starts_with("\xFF\xD8\xFF")) return "image/jpeg";
  if (begin.starts_with("RIFF") && begin.ends_with("WEBP")) return "image/webp";
  if (begin.starts_with("\xABKTX 20")) return "image/ktx2";
  return nullptr;
}

// Copies the parts of buffers that views use, each once, into one buffer; views may overlap.
class Packer {
 public:
  using Buffers = std::vector<std::shared_ptr<std::vector<std::uint8_t>>>;

  std::string pack(const GltfPlace& views, const Buffers& buffers, Json& json) {
    findFirsts(buffers);
    for (std::size_t i = 0; i < views.size(); ++i) parts_[startOf(views.at(i))] = 0;
    std::map<Start, std::size_t> ends;
    for (std::size_t i = 0; i < views.size(); ++i) {
      std::size_t& end = ends[startOf(views.at(i))];
      const GltfPlace view = views.at(i);
      end = std::max(end, view["byteOffset"].countOr(0) + view["byteLength"].count());
    }
    copyParts(buffers, ends);
    for (std::size_t i = 0; i < views.size(); ++i) {
      const Start start = startOf(views.at(i));
      const std::size_t within = views.at(i)["byteOffset"].countOr(0) - start.second;
      Json& view = findMember(json, "bufferViews")->list()[i];
      putMember(view, "buffer", 0);
      putMember(view, "byteOffset", Json::Number{std::to_string(parts_[start] + within)});
    }
    return std::move(bytes_);
  }

 private:
  using Start = std::pair<std::size_t, std::size_t>;  // buffer, first byte (a multiple of four)

  Start startOf(const GltfPlace& view) const {
    return {firsts_[view["buffer"].count()], view["byteOffset"].countOr(0) / 4 * 4};
  }

  // Of buffers that are one file, the first stands for all.
  void findFirsts(const Buffers& buffers) {
    std::map<const void*, std::size_t> known;
    for (std::size_t b = 0; b < buffers.size(); ++b)
      firsts_.push_back(known.try_emplace(buffers[b].get(), b).first->second);
  }

  // Fills parts_: where each start went. Overlapping parts keep their distance.
  void copyParts(const Buffers& buffers, const std::map<Start, std::size_t>& ends) {
    Start open{std::numeric_limits<std::size_t>::max(), 0};
    std::size_t copied = 0;  // how far the buffer of `open` has been copied
    for (const auto& [start, end] : ends) {
      const std::vector<std::uint8_t>& from = *buffers[start.first];
      if (start.first != open.first || start.second > copied) {
        bytes_.resize((bytes_.size() + 3) / 4 * 4);
        open = start;
        copied = start.second;
        base_ = bytes_.size();
      }
      parts_[start] = base_ + (start.second - open.second);
      if (end <= copied) continue;
      bytes_.append(reinterpret_cast<const char*>(from.data()) + copied, end - copied);
      copied = end;
    }
  }

  std::vector<std::size_t> firsts_;  // per buffer
  std::map<Start, std::size_t> parts_;
  std::string bytes_;
  std::size_t base_ = 0;  // where `open` went
};

std::string glbOf(const Json& json, std::string binary, const std::string& path) {
  std::string text = compactJson(json);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4);
  const std::size_t total = 12 + 8 + text.size() + (binary.empty() ? 0 : 8 + binary.size());
  if (total > kMostGlbBytes) {
    Issue issue;
    issue.where.file = path;
    issue.message = "would be larger than 4 GiB, which the format cannot hold";
    throw Error(std::move(issue));
  }
  ByteWriter out;
  out.bytes.reserve(total);
  out.bytes += "glTF";
  out.value(std::uint32_t{2});
  out.value(static_cast<std::uint32_t>(total));
  out.value(static_cast<std::uint32_t>(text.size()));
  out.bytes += "JSON";
  out.bytes += text;
  if (!binary.empty()) {
    out.value(static_cast<std::uint32_t>(binary.size()));
    out.bytes += std::string_view("BIN\0", 4);
    out.bytes += binary;
  }
  return std::move(out.bytes);
}

}  // namespace

int GltfDocument::addImage(std::span<const std::uint8_t> encoded) {
  Json image = Json::Object{{"bufferView", addView(encoded.data(), encoded.size(), Target::none)}};
  if (const char* mimeType = mimeTypeOf({encoded.begin(), encoded.end()}))
    image.set("mimeType", mimeType);
  return add("images", std::move(image));
}

void GltfDocument::embedImages() {
  const std::size_t count = root()["images"].size();
  for (std::size_t i = 0; i < count; ++i) {
    if (!root()["images"].at(i)["uri"]) continue;
    const std::vector<std::uint8_t> bytes = image(static_cast<int>(i));
    const char* mimeType = mimeTypeOf(bytes);
    if (!mimeType) continue;  // not found, or nothing that a .glb may hold: stays where it is
    const int view = addView(bytes.data(), bytes.size(), Target::none);
    Json& entry = findMember(json_, "images")->list()[i];
    eraseMember(entry, "uri");
    putMember(entry, "bufferView", view);
    putMember(entry, "mimeType", mimeType);
  }
}

void GltfDocument::writeGlb(const std::string& path) const {
  writeFileWhole(path, glb());
}

std::string GltfDocument::glb() const {
  GltfDocument packed = *this;
  packed.embedImages();
  checkGltfReferences(packed.root());
  if (!hasUnknownReferences(packed.root())) {
    dropUnused(packed.json_, "accessors", accessorReferences(packed.json_));
    dropUnused(packed.json_, "bufferViews", viewReferences(packed.json_));
  }
  const GltfPlace views = packed.root()["bufferViews"];
  for (std::size_t i = 0; i < views.size(); ++i) packed.viewBytes(static_cast<int>(i));  // checks
  // A copy: places look into packed.json_ while its views are renumbered.
  Json json = packed.json_;
  std::string binary = Packer().pack(views, packed.buffers_, json);
  eraseMember(json, "buffers");
  if (!binary.empty()) {
    putMember(json, "buffers", Json::List{Json::Object{{"byteLength", binary.size()}}});
  }
  return glbOf(json, std::move(binary), path_);
}

}  // namespace fascia
