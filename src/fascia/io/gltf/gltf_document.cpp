#include <fascia/io/gltf/gltf_document.h>

#include <algorithm>
#include <atomic>
#include <limits>

#include <fascia/io/gltf/gltf_accessor.h>

namespace fascia {
namespace {

// Calls put(index of the number, number) for every component of every element; sparse values last.
template <class Put>
void decode(const GltfAccessor& accessor, const Put& put) {
  const auto components = static_cast<std::size_t>(accessor.components);
  if (accessor.data) {
    for (std::size_t i = 0; i < accessor.count; ++i) {
      const std::uint8_t* element = accessor.data + i * accessor.stride;
      for (std::size_t c = 0; c < components; ++c) {
        put(i * components + c, accessor.number(element, c));
      }
    }
  }
  const std::size_t packed = accessor.offsets.back() + componentBytes(accessor.componentType);
  for (std::size_t i = 0; i < accessor.sparseIndices.size(); ++i) {
    for (std::size_t c = 0; c < components; ++c) {
      put(accessor.sparseIndices[i] * components + c,
          accessor.number(accessor.sparseData + i * packed, c));
    }
  }
}

GltfAccessor checked(const GltfDocument& document, int accessor, int components) {
  const GltfPlace accessors = document.root()["accessors"];
  if (accessor < 0 || static_cast<std::size_t>(accessor) >= accessors.size()) {
    accessors.fail("there is no accessor " + std::to_string(accessor));
  }
  GltfAccessor out = GltfAccessor::of(document, accessor);
  if (out.components != components) {
    accessors.at(static_cast<std::size_t>(accessor))["type"].fail(
        "found " + std::to_string(out.components) + " components, expected " +
        std::to_string(components));
  }
  return out;
}

}  // namespace

GltfDocument::GltfDocument(std::string path)
    : path_(std::move(path)),
      json_(Json::Object{{"asset", Json::Object{{"version", "2.0"}, {"generator", "Fascia"}}}}) {}

std::span<const std::uint8_t> GltfDocument::viewBytes(int bufferView) const {
  const GltfPlace view = root()["bufferViews"].at(static_cast<std::size_t>(bufferView));
  return part(view["buffer"].index(static_cast<int>(buffers_.size())), view);
}

// The bytes that "byteOffset" and "byteLength" at a place tell.
std::span<const std::uint8_t> GltfDocument::part(int buffer, const GltfPlace& place) const {
  const std::vector<std::uint8_t>& bytes = *buffers_[static_cast<std::size_t>(buffer)];
  const std::size_t first = place["byteOffset"].countOr(0), length = place["byteLength"].count();
  if (first > bytes.size() || length > bytes.size() - first) {
    place.fail("reaches byte " + std::to_string(first + length) + " of a buffer of " +
                   std::to_string(bytes.size()),
               "is the file cut short?");
  }
  return std::span(bytes).subspan(first, length);
}

std::size_t GltfDocument::elementCount(int accessor) const {
  const GltfPlace accessors = root()["accessors"];
  if (accessor < 0 || static_cast<std::size_t>(accessor) >= accessors.size()) {
    accessors.fail("there is no accessor " + std::to_string(accessor));
  }
  return GltfAccessor::of(*this, accessor).count;
}

// An accessor may be named any number of times, and is decoded each time.
void GltfDocument::charge(std::size_t numbers, int accessor) const {
  constexpr std::size_t kMostNumbers = 1'000'000'000;
  // Players of one document are made side by side.
  const std::size_t all = std::atomic_ref(decoded_).fetch_add(numbers) + numbers;
  if (numbers <= kMostNumbers && all <= kMostNumbers) return;
  root()["accessors"]
      .at(static_cast<std::size_t>(accessor))
      .fail("asks for more than " + std::to_string(kMostNumbers) + " numbers in all");
}

std::vector<float> GltfDocument::floats(int accessor, int components) const {
  const GltfAccessor source = checked(*this, accessor, components);
  charge(source.count * static_cast<std::size_t>(components), accessor);
  std::vector<float> out(source.count * static_cast<std::size_t>(components), 0.f);
  decode(source, [&](std::size_t i, double value) { out[i] = static_cast<float>(value); });
  return out;
}

std::vector<std::uint32_t> GltfDocument::integers(int accessor, int components) const {
  GltfAccessor source = checked(*this, accessor, components);
  charge(source.count * static_cast<std::size_t>(components), accessor);
  source.normalized = false;
  std::vector<std::uint32_t> out(source.count * static_cast<std::size_t>(components), 0);
  decode(source, [&](std::size_t i, double value) {  // some exporters write joints as floats
    const bool fits = value >= 0 && value <= 4294967295.0;
    out[i] = fits ? static_cast<std::uint32_t>(value) : std::numeric_limits<std::uint32_t>::max();
  });
  return out;
}

std::vector<std::uint8_t> GltfDocument::image(int image) const {
  const GltfPlace images = root()["images"];
  const GltfPlace place = images.at(static_cast<std::size_t>(image));
  if (place["bufferView"]) {
    const auto views = static_cast<int>(root()["bufferViews"].size());
    const std::span<const std::uint8_t> bytes = viewBytes(place["bufferView"].index(views));
    return {bytes.begin(), bytes.end()};
  }
  if (!place["uri"]) return {};
  try {
    return *dataOf(place["uri"].text(), place["uri"]);
  } catch (const Error&) {
    return {};  // a character without its picture is still a character
  }
}

}  // namespace fascia
