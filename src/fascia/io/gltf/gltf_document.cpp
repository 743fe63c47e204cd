#include <fascia/io/gltf/gltf_document.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <fascia/io/gltf/gltf_document_accessor.h>

namespace fascia {
namespace {

constexpr int kVertexTarget = 34962, kIndexTarget = 34963;

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

Json numbersJson(std::span<const float> values) {
  Json::List list;
  for (const float v : values) list.emplace_back(Json::Number{shortestDigits(v)});
  return list;
}

// Adds "min" and "max" of an accessor's values; `zero`: elements that are not given are zeros.
void putRange(Json& accessor, std::span<const float> values, std::size_t components, bool zero) {
  std::vector<float> low(components, zero ? 0.f : std::numeric_limits<float>::infinity());
  std::vector<float> high(components, zero ? 0.f : -std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < values.size(); ++i) {
    low[i % components] = std::min(low[i % components], values[i]);
    high[i % components] = std::max(high[i % components], values[i]);
  }
  if (values.empty() && !zero) return;
  putMember(accessor, "min", numbersJson(low));
  putMember(accessor, "max", numbersJson(high));
}

// Elements of vertex attributes begin at multiples of four bytes: pads odd ones.
template <class T>
std::vector<T> paddedTo4(std::span<const T> values, std::size_t components, std::size_t padded) {
  std::vector<T> out(values.size() / components * padded, T{0});
  for (std::size_t i = 0; i < values.size(); ++i) {
    out[i / components * padded + i % components] = values[i];
  }
  return out;
}

}  // namespace

std::span<const std::uint8_t> GltfDocument::viewBytes(int bufferView) const {
  const GltfPlace view = root()["bufferViews"].at(static_cast<std::size_t>(bufferView));
  return part(view["buffer"].index(static_cast<int>(buffers_.size())), view);
}

// The bytes that "byteOffset" and "byteLength" at a place tell.
std::span<const std::uint8_t> GltfDocument::part(int buffer, const GltfPlace& place) const {
  const std::vector<std::uint8_t>& bytes = buffers_[static_cast<std::size_t>(buffer)];
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

std::vector<float> GltfDocument::floats(int accessor, int components) const {
  const GltfAccessor source = checked(*this, accessor, components);
  std::vector<float> out(source.count * static_cast<std::size_t>(components), 0.f);
  decode(source, [&](std::size_t i, double value) { out[i] = static_cast<float>(value); });
  return out;
}

std::vector<std::uint32_t> GltfDocument::integers(int accessor, int components) const {
  GltfAccessor source = checked(*this, accessor, components);
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
    return dataOf(place["uri"].text(), place["uri"]);
  } catch (const Error&) {
    return {};  // a character without its picture is still a character
  }
}

int GltfDocument::addBuffer(std::vector<std::uint8_t> bytes) {
  Json buffer{Json::Object{}};
  buffer.set("byteLength", Json::Number{std::to_string(bytes.size())});
  ensureList(json_, "buffers").list().push_back(std::move(buffer));
  buffers_.push_back(std::move(bytes));
  return static_cast<int>(buffers_.size()) - 1;
}

int GltfDocument::addView(const void* data, std::size_t bytes, int target, std::size_t stride) {
  if (ownBuffer_ < 0) ownBuffer_ = addBuffer({});
  std::vector<std::uint8_t>& own = buffers_[static_cast<std::size_t>(ownBuffer_)];
  own.resize((own.size() + 3) / 4 * 4);
  Json view{Json::Object{}};
  view.set("buffer", ownBuffer_);
  view.set("byteOffset", Json::Number{std::to_string(own.size())});
  view.set("byteLength", Json::Number{std::to_string(bytes)});
  if (stride > 0) view.set("byteStride", static_cast<int>(stride));
  if (target > 0) view.set("target", target);
  const auto* first = static_cast<const std::uint8_t*>(data);
  own.insert(own.end(), first, first + bytes);
  putMember(ensureList(json_, "buffers").list()[static_cast<std::size_t>(ownBuffer_)], "byteLength",
            Json::Number{std::to_string(own.size())});
  Json::List& views = ensureList(json_, "bufferViews").list();
  views.push_back(std::move(view));
  return static_cast<int>(views.size()) - 1;
}

int GltfDocument::addAccessor(Json view, int componentType, std::size_t count,
                              std::string_view type, bool normalized) {
  Json accessor{Json::Object{}};
  if (!view.is(Json::Kind::null)) accessor.set("bufferView", std::move(view));
  accessor.set("componentType", componentType);
  accessor.set("count", Json::Number{std::to_string(count)});
  accessor.set("type", type);
  if (normalized) accessor.set("normalized", true);
  Json::List& accessors = ensureList(json_, "accessors").list();
  accessors.push_back(std::move(accessor));
  return static_cast<int>(accessors.size()) - 1;
}

int GltfDocument::addFloats(std::span<const float> values, std::string_view type, bool withRange) {
  const auto components = static_cast<std::size_t>(componentCount(type));
  const int view = addView(values.data(), values.size_bytes(), 0);
  const int index = addAccessor(view, kGltfFloat, values.size() / components, type, false);
  if (withRange) {
    Json& accessor = findMember(json_, "accessors")->list()[static_cast<std::size_t>(index)];
    putRange(accessor, values, components, false);
  }
  return index;
}

int GltfDocument::addBytes(std::span<const std::uint8_t> values, std::string_view type,
                           bool normalized) {
  const auto components = static_cast<std::size_t>(componentCount(type));
  const std::size_t padded = (components + 3) / 4 * 4;
  const std::vector<std::uint8_t> data = paddedTo4(values, components, padded);
  const int view =
      addView(data.data(), data.size(), kVertexTarget, padded == components ? 0 : padded);
  return addAccessor(view, kGltfUnsignedByte, values.size() / components, type, normalized);
}

int GltfDocument::addShorts(std::span<const std::uint16_t> values, std::string_view type,
                            bool normalized) {
  const auto components = static_cast<std::size_t>(componentCount(type));
  const std::size_t padded = (components + 1) / 2 * 2;
  const std::vector<std::uint16_t> data = paddedTo4(values, components, padded);
  const int view = addView(data.data(), data.size() * sizeof data[0], kVertexTarget,
                           padded == components ? 0 : padded * sizeof data[0]);
  return addAccessor(view, kGltfUnsignedShort, values.size() / components, type, normalized);
}

int GltfDocument::addIndices(std::span<const std::uint32_t> values) {
  // The largest number of a type restarts strips and is no index.
  const bool small = std::all_of(values.begin(), values.end(), [](auto v) { return v < 65535; });
  if (!small) {
    const int view = addView(values.data(), values.size_bytes(), kIndexTarget);
    return addAccessor(view, kGltfUnsignedInt, values.size(), "SCALAR", false);
  }
  const std::vector<std::uint16_t> packed(values.begin(), values.end());
  const int view = addView(packed.data(), packed.size() * sizeof packed[0], kIndexTarget);
  return addAccessor(view, kGltfUnsignedShort, packed.size(), "SCALAR", false);
}

int GltfDocument::addSparseFloats(std::span<const std::uint32_t> indices,
                                  std::span<const float> values, std::size_t count,
                                  std::string_view type, bool withRange) {
  const auto components = static_cast<std::size_t>(componentCount(type));
  Json sparse{Json::Object{}};
  if (!indices.empty()) {
    Json where{Json::Object{}}, what{Json::Object{}};
    where.set("bufferView", addView(indices.data(), indices.size_bytes(), 0));
    where.set("componentType", static_cast<int>(kGltfUnsignedInt));
    what.set("bufferView", addView(values.data(), values.size_bytes(), 0));
    sparse.set("count", Json::Number{std::to_string(indices.size())});
    sparse.set("indices", std::move(where));
    sparse.set("values", std::move(what));
  }
  const int index = addAccessor(Json(), kGltfFloat, count, type, false);
  Json& accessor = findMember(json_, "accessors")->list()[static_cast<std::size_t>(index)];
  if (!indices.empty()) accessor.set("sparse", std::move(sparse));
  if (withRange) putRange(accessor, values, components, indices.size() < count);
  return index;
}

}  // namespace fascia
