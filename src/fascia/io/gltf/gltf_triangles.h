#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace fascia {

inline constexpr int kGltfTriangles = 4, kGltfFan = 6;  // between them: strips; below: no triangles

// Triangles out of a primitive's run of indices (glTF 2.0, 3.7.2.1).
inline std::vector<std::array<std::uint32_t, 3>> gltfTriangles(
    int mode, const std::vector<std::uint32_t>& run) {
  std::vector<std::array<std::uint32_t, 3>> out;
  if (mode == kGltfTriangles) {
    for (std::size_t i = 0; i + 3 <= run.size(); i += 3)
      out.push_back({run[i], run[i + 1], run[i + 2]});
    return out;
  }
  for (std::size_t i = 0; i + 3 <= run.size(); ++i) {
    if (mode == kGltfFan)
      out.push_back({run[i + 1], run[i + 2], run[0]});
    else
      out.push_back({run[i], run[i + 1 + i % 2], run[i + 2 - i % 2]});
  }
  return out;
}

}  // namespace fascia
