#include <fascia/io/gltf/gltf_accessor.h>

#include <algorithm>
#include <cstring>

namespace fascia {
namespace {

// An accessor without data is all zeros: its count is checked against nothing else.
constexpr std::size_t kMostZeros = 1u << 20;

// Where the components of an element lie. Columns of matrices begin at multiples of four bytes
// (glTF 2.0, 3.6.2.4).
std::vector<std::size_t> componentOffsets(std::string_view type, std::size_t bytes) {
  const auto components = static_cast<std::size_t>(componentCount(type));
  const bool matrix = type.starts_with("MAT");
  const std::size_t rows = matrix ? static_cast<std::size_t>(type[3] - '0') : components;
  const std::size_t column = matrix ? (rows * bytes + 3) / 4 * 4 : rows * bytes;
  std::vector<std::size_t> offsets;
  for (std::size_t i = 0; i < components; ++i) {
    offsets.push_back(i / rows * column + i % rows * bytes);
  }
  return offsets;
}

template <class T>
T read(const std::uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

// `count` elements that begin `first` bytes into the view of `place`.
const std::uint8_t* checkedData(const GltfDocument& document, const GltfPlace& place,
                                std::size_t count, std::size_t stride, std::size_t element) {
  const GltfPlace view = place["bufferView"];
  const int index = view.index(static_cast<int>(document.root()["bufferViews"].size()));
  const std::span<const std::uint8_t> bytes = document.viewBytes(index);
  const std::size_t first = place["byteOffset"].countOr(0);
  if (count == 0) return bytes.data();
  const bool fits = first <= bytes.size() && element <= bytes.size() - first &&
                    count - 1 <= (bytes.size() - first - element) / stride;
  if (!fits) {
    place.fail("found " + std::to_string(count) + " elements in a buffer view of " +
                   std::to_string(bytes.size()) + " bytes, which are too few",
               "is the file cut short?");
  }
  return bytes.data() + first;
}

std::size_t viewStride(const GltfDocument& document, const GltfPlace& place, std::size_t element) {
  const GltfPlace views = document.root()["bufferViews"];
  const int view = place["bufferView"].index(static_cast<int>(views.size()));
  const GltfPlace stride = views.at(static_cast<std::size_t>(view))["byteStride"];
  const std::size_t bytes = stride.countOr(element);
  if (bytes < element || bytes > 1024) stride.fail("does not fit its elements");
  return bytes;
}

void readSparse(const GltfDocument& document, const GltfPlace& sparse, std::size_t element,
                GltfAccessor& out) {
  const GltfPlace indices = sparse["indices"], values = sparse["values"];
  const std::size_t count = sparse["count"].count();
  if (count > out.count) sparse["count"].fail("more sparse values than elements");
  const std::size_t type = indices["componentType"].count();
  const std::size_t bytes = type <= kGltfUnsignedInt ? componentBytes(static_cast<int>(type)) : 0;
  if (bytes == 0 || type == kGltfByte || type == kGltfShort) {
    indices["componentType"].fail("is no type of indices");
  }
  const std::uint8_t* at = checkedData(document, indices, count, bytes, bytes);
  out.sparseData = checkedData(document, values, count, element, element);
  out.sparseIndices.reserve(count);
  for (std::size_t i = 0; i < count; ++i, at += bytes) {
    const std::uint32_t index = bytes == 1   ? *at
                                : bytes == 2 ? read<std::uint16_t>(at)
                                             : read<std::uint32_t>(at);
    if (index >= out.count) {
      indices.fail("found sparse index " + std::to_string(index) + " of " +
                   std::to_string(out.count) + " elements");
    }
    out.sparseIndices.push_back(index);
  }
}

}  // namespace

std::size_t componentBytes(int componentType) {
  switch (componentType) {
    case kGltfByte:
    case kGltfUnsignedByte:
      return 1;
    case kGltfShort:
    case kGltfUnsignedShort:
      return 2;
    case kGltfUnsignedInt:
    case kGltfFloat:
      return 4;
    default:
      return 0;
  }
}

int componentCount(std::string_view type) {
  constexpr std::pair<std::string_view, int> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16},
  };
  for (const auto& [name, count] : kTypes) {
    if (name == type) return count;
  }
  return 0;
}

GltfAccessor GltfAccessor::of(const GltfDocument& document, int accessor) {
  const GltfPlace place = document.root()["accessors"].at(static_cast<std::size_t>(accessor));
  GltfAccessor out;
  const std::string type = place["type"].text();
  out.components = componentCount(type);
  if (out.components == 0) place["type"].fail("is no type of accessor: " + jsonText(type));
  const std::size_t componentType = place["componentType"].count();
  out.componentType = componentType <= kGltfFloat ? static_cast<int>(componentType) : 0;
  const std::size_t bytes = componentBytes(out.componentType);
  if (bytes == 0) place["componentType"].fail("is no type of component");
  out.normalized = place["normalized"].flagOr(false);
  out.count = place["count"].count();
  out.offsets = componentOffsets(type, bytes);
  const std::size_t element = out.offsets.back() + bytes;
  if (place["bufferView"]) {
    out.stride = viewStride(document, place, element);
    out.data = checkedData(document, place, out.count, out.stride, element);
  } else if (out.count > kMostZeros) {
    place["count"].fail("found " + std::to_string(out.count) + " elements without data");
  }
  if (place["sparse"]) readSparse(document, place["sparse"], element, out);
  return out;
}

// Normalised integers: glTF 2.0, 3.11.
double GltfAccessor::number(const std::uint8_t* element, std::size_t component) const {
  const std::uint8_t* at = element + offsets[component];
  double value = 0, most = 1;
  switch (componentType) {
    case kGltfByte:
      value = read<std::int8_t>(at), most = 127;
      break;
    case kGltfUnsignedByte:
      value = *at, most = 255;
      break;
    case kGltfShort:
      value = read<std::int16_t>(at), most = 32767;
      break;
    case kGltfUnsignedShort:
      value = read<std::uint16_t>(at), most = 65535;
      break;
    case kGltfUnsignedInt:
      value = read<std::uint32_t>(at), most = 4294967295.0;
      break;
    default:
      return read<float>(at);
  }
  return normalized ? std::max(value / most, -1.0) : value;
}

}  // namespace fascia
