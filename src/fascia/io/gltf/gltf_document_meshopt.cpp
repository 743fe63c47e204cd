// EXT_meshopt_compression: buffer views whose data are packed.
#include <algorithm>

#include <meshoptimizer.h>

#include <fascia/io/gltf/gltf_document.h>

namespace fascia {
namespace {

constexpr const char* kMeshoptExtension = "EXT_meshopt_compression";

struct PackedView {
  std::span<const std::uint8_t> data;
  std::size_t count = 0, stride = 0;
  std::string mode, filter;
};

// What the decoder takes for granted.
void checkLayout(const PackedView& view, const GltfPlace& place) {
  const bool vertices = view.mode == "ATTRIBUTES";
  const bool triangles = view.mode == "TRIANGLES";
  if (!vertices && !triangles && view.mode != "INDICES") place["mode"].fail("is no known mode");
  const bool strideFits = vertices ? view.stride > 0 && view.stride <= 256 && view.stride % 4 == 0
                                   : view.stride == 2 || view.stride == 4;
  if (!strideFits) place["byteStride"].fail("does not fit the mode " + view.mode);
  if (triangles && view.count % 3 != 0) place["count"].fail("is no multiple of three");
  const bool filterFits =
      view.filter == "NONE" ||
      (vertices &&
       ((view.filter == "OCTAHEDRAL" && (view.stride == 4 || view.stride == 8)) ||
        (view.filter == "QUATERNION" && view.stride == 8) || view.filter == "EXPONENTIAL"));
  if (!filterFits) place["filter"].fail("found " + view.filter + ", which does not fit");
  // At best 256 bytes shrink to 4 bytes: more is a lie that would only cost memory.
  constexpr std::size_t kMostGrowth = 128;
  if (view.count / kMostGrowth > view.data.size() / view.stride + 1) {
    place["count"].fail("found " + std::to_string(view.count) + " elements in " +
                        std::to_string(view.data.size()) + " packed bytes");
  }
}

std::vector<std::uint8_t> unpack(const PackedView& view, const GltfPlace& place) {
  std::vector<std::uint8_t> out(view.count * view.stride);
  const std::uint8_t* from = view.data.data();
  int failed = 0;
  if (view.mode == "ATTRIBUTES") {
    failed =
        meshopt_decodeVertexBuffer(out.data(), view.count, view.stride, from, view.data.size());
  } else if (view.mode == "TRIANGLES") {
    failed = meshopt_decodeIndexBuffer(out.data(), view.count, view.stride, from, view.data.size());
  } else {
    failed =
        meshopt_decodeIndexSequence(out.data(), view.count, view.stride, from, view.data.size());
  }
  if (failed != 0) place.fail("its data can't be unpacked", "is the file damaged?");
  if (view.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), view.count, view.stride);
  if (view.filter == "QUATERNION") meshopt_decodeFilterQuat(out.data(), view.count, view.stride);
  if (view.filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), view.count, view.stride);
  return out;
}

}  // namespace

void GltfDocument::unpackCompressedViews() {
  const std::size_t count = root()["bufferViews"].size();
  for (std::size_t i = 0; i < count; ++i) {
    const GltfPlace place = root()["bufferViews"].at(i)["extensions"][kMeshoptExtension];
    if (!place) continue;
    const int buffer = place["buffer"].index(static_cast<int>(buffers_.size()));
    PackedView view;
    view.data = part(buffer, place);
    view.count = place["count"].count();
    view.stride = place["byteStride"].count();
    view.mode = place["mode"].text();
    view.filter = place["filter"].textOr("NONE");
    checkLayout(view, place);
    std::vector<std::uint8_t> data = unpack(view, place);
    Json& entry = findMember(json_, "bufferViews")->list()[i];
    Json* extensions = findMember(entry, "extensions");
    eraseMember(*extensions, kMeshoptExtension);
    if (extensions->object().empty()) eraseMember(entry, "extensions");
    putMember(entry, "byteOffset", 0);
    putMember(entry, "byteLength", Json::Number{std::to_string(data.size())});
    const int unpacked = addBuffer(std::move(data));  // `entry` may have moved
    putMember(findMember(json_, "bufferViews")->list()[i], "buffer", unpacked);
  }
  forgetExtension(kMeshoptExtension);
}

void GltfDocument::forgetExtension(std::string_view name) {
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    Json* names = findMember(json_, list);
    if (!names || !names->is(Json::Kind::list)) continue;
    std::erase_if(names->list(), [&](const Json& entry) {
      return entry.is(Json::Kind::text) && entry.text() == name;
    });
    if (names->list().empty()) eraseMember(json_, list);
  }
}

}  // namespace fascia
