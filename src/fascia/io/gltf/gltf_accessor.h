#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fascia/io/gltf/gltf_document.h>

namespace fascia {

enum GltfComponent : int {
  kGltfByte = 5120,
  kGltfUnsignedByte = 5121,
  kGltfShort = 5122,
  kGltfUnsignedShort = 5123,
  kGltfUnsignedInt = 5125,
  kGltfFloat = 5126,
};

std::size_t componentBytes(int componentType);  // 0: no such type
int componentCount(std::string_view type);      // "VEC3" -> 3; 0: no such type

// An accessor with everything checked: `data` and the sparse parts may be read as described.
struct GltfAccessor {
  std::size_t count = 0;
  int components = 0, componentType = kGltfFloat;
  bool normalized = false;
  const std::uint8_t* data = nullptr;  // nullptr: all zeros
  std::size_t stride = 0;
  std::vector<std::size_t> offsets;  // of an element's components, in bytes

  std::vector<std::uint32_t> sparseIndices;  // below count
  const std::uint8_t* sparseData = nullptr;  // packed elements

  // Throws Error where the file contradicts itself.
  static GltfAccessor of(const GltfDocument& document, int accessor);

  double number(const std::uint8_t* element, std::size_t component) const;
};

}  // namespace fascia
