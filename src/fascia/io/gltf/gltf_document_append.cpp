// Appending data: all of it goes into one buffer of our own.
#include <algorithm>
#include <limits>

#include <fascia/io/gltf/gltf_accessor.h>
#include <fascia/io/gltf/gltf_document.h>

namespace fascia {
namespace {

// The largest number of a type restarts strips and is no index.
constexpr std::uint32_t kShortIndexLimit = 65535;

// Adds "min" and "max" of an accessor's values; `zero`: elements that are not given are zeros.
void putRange(Json& accessor, std::span<const float> values, std::size_t components, bool zero) {
  std::vector<float> low(components, zero ? 0.f : std::numeric_limits<float>::infinity());
  std::vector<float> high(components, zero ? 0.f : -std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < values.size(); ++i) {
    low[i % components] = std::min(low[i % components], values[i]);
    high[i % components] = std::max(high[i % components], values[i]);
  }
  if (values.empty() && !zero) return;
  putMember(accessor, "min", numberList(low));
  putMember(accessor, "max", numberList(high));
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

std::size_t componentsOf(std::string_view type) {
  return static_cast<std::size_t>(componentCount(type));
}

}  // namespace

int GltfDocument::add(const char* list, Json entry) {
  Json::List& entries = ensureList(json_, list).list();
  entries.push_back(std::move(entry));
  return static_cast<int>(entries.size()) - 1;
}

Json& GltfDocument::item(const char* list, int index) {
  return ensureList(json_, list).list().at(static_cast<std::size_t>(index));
}

int GltfDocument::addBuffer(std::vector<std::uint8_t> bytes) {
  buffers_.push_back(std::make_shared<std::vector<std::uint8_t>>(std::move(bytes)));
  return add("buffers", Json::Object{{"byteLength", buffers_.back()->size()}});
}

int GltfDocument::addView(const void* data, std::size_t bytes, Target target, std::size_t stride) {
  if (ownBuffer_ < 0) ownBuffer_ = addBuffer({});
  Bytes& shared = buffers_[static_cast<std::size_t>(ownBuffer_)];
  if (shared.use_count() > 1) shared = std::make_shared<std::vector<std::uint8_t>>(*shared);
  std::vector<std::uint8_t>& own = *shared;
  own.resize((own.size() + 3) / 4 * 4);
  Json view =
      Json::Object{{"buffer", ownBuffer_}, {"byteOffset", own.size()}, {"byteLength", bytes}};
  if (stride > 0) view.set("byteStride", stride);
  if (target != Target::none) view.set("target", static_cast<int>(target));
  const auto* first = static_cast<const std::uint8_t*>(data);
  own.insert(own.end(), first, first + bytes);
  putMember(item("buffers", ownBuffer_), "byteLength", own.size());
  return add("bufferViews", std::move(view));
}

int GltfDocument::addAccessor(Json view, int componentType, std::size_t count,
                              std::string_view type, bool normalized) {
  Json accessor{Json::Object{}};
  if (!view.is(Json::Kind::null)) accessor.set("bufferView", std::move(view));
  accessor.set("componentType", componentType);
  accessor.set("count", count);
  accessor.set("type", type);
  if (normalized) accessor.set("normalized", true);
  return add("accessors", std::move(accessor));
}

int GltfDocument::addFloats(std::span<const float> values, std::string_view type, bool withRange,
                            Target target) {
  const std::size_t components = componentsOf(type);
  const int view = addView(values.data(), values.size_bytes(), target);
  const int index = addAccessor(view, kGltfFloat, values.size() / components, type, false);
  if (withRange) putRange(item("accessors", index), values, components, false);
  return index;
}

int GltfDocument::addBytes(std::span<const std::uint8_t> values, std::string_view type,
                           bool normalized) {
  const std::size_t components = componentsOf(type), padded = (components + 3) / 4 * 4;
  const std::vector<std::uint8_t> data = paddedTo4(values, components, padded);
  const int view =
      addView(data.data(), data.size(), Target::vertices, padded == components ? 0 : padded);
  return addAccessor(view, kGltfUnsignedByte, values.size() / components, type, normalized);
}

int GltfDocument::addShorts(std::span<const std::uint16_t> values, std::string_view type,
                            bool normalized) {
  const std::size_t components = componentsOf(type), padded = (components + 1) / 2 * 2;
  const std::vector<std::uint16_t> data = paddedTo4(values, components, padded);
  const int view = addView(data.data(), data.size() * sizeof data[0], Target::vertices,
                           padded == components ? 0 : padded * sizeof data[0]);
  return addAccessor(view, kGltfUnsignedShort, values.size() / components, type, normalized);
}

int GltfDocument::addJoints(std::span<const std::uint16_t> values) {
  const bool small = std::all_of(values.begin(), values.end(), [](auto v) { return v < 256; });
  if (!small) return addShorts(values, "VEC4");
  return addBytes(std::vector<std::uint8_t>(values.begin(), values.end()), "VEC4");
}

int GltfDocument::addShortKeys(std::span<const std::int16_t> values, std::string_view type) {
  const int view = addView(values.data(), values.size_bytes(), Target::none);
  return addAccessor(view, kGltfShort, values.size() / componentsOf(type), type, true);
}

int GltfDocument::addShortKeys(std::span<const std::uint16_t> values, std::string_view type) {
  const int view = addView(values.data(), values.size_bytes(), Target::none);
  return addAccessor(view, kGltfUnsignedShort, values.size() / componentsOf(type), type, true);
}

int GltfDocument::addPackedIndices(std::span<const std::uint32_t> values, bool small,
                                   Target target) {
  if (!small) return addView(values.data(), values.size_bytes(), target);
  const std::vector<std::uint16_t> packed(values.begin(), values.end());
  return addView(packed.data(), packed.size() * sizeof packed[0], target);
}

int GltfDocument::addIndices(std::span<const std::uint32_t> values) {
  const bool small = std::all_of(values.begin(), values.end(),
                                 [](std::uint32_t v) { return v < kShortIndexLimit; });
  const int view = addPackedIndices(values, small, Target::indices);
  return addAccessor(view, small ? kGltfUnsignedShort : kGltfUnsignedInt, values.size(), "SCALAR",
                     false);
}

int GltfDocument::addSparseVectors(std::span<const float> values, bool withRange, Target target) {
  const std::size_t count = values.size() / 3;
  std::vector<std::uint32_t> indices;
  std::vector<float> kept;
  for (std::size_t i = 0; i < count; ++i) {
    const std::span<const float> v = values.subspan(3 * i, 3);
    if (v[0] == 0 && v[1] == 0 && v[2] == 0) continue;
    indices.push_back(static_cast<std::uint32_t>(i));
    kept.insert(kept.end(), v.begin(), v.end());
  }
  const std::size_t indexBytes = count <= kShortIndexLimit ? 2 : 4;
  const std::size_t bytes = indices.size() * (indexBytes + 3 * sizeof(float));
  if (bytes >= values.size_bytes()) return addFloats(values, "VEC3", withRange, target);
  return addSparse(indices, kept, count, withRange);
}

// An accessor without a buffer view is all zeros.
int GltfDocument::addSparse(std::span<const std::uint32_t> indices, std::span<const float> values,
                            std::size_t count, bool withRange) {
  Json accessor = Json::Object{
      {"componentType", static_cast<int>(kGltfFloat)}, {"count", count}, {"type", "VEC3"}};
  if (!indices.empty()) {
    const bool small = count <= kShortIndexLimit;
    const int where = addPackedIndices(indices, small, Target::none);
    const int what = addView(values.data(), values.size_bytes(), Target::none);
    const int type = small ? kGltfUnsignedShort : kGltfUnsignedInt;
    accessor.set(
        "sparse",
        Json::Object{{"count", indices.size()},
                     {"indices", Json::Object{{"bufferView", where}, {"componentType", type}}},
                     {"values", Json::Object{{"bufferView", what}}}});
  }
  if (withRange) putRange(accessor, values, 3, true);
  return add("accessors", std::move(accessor));
}

}  // namespace fascia
