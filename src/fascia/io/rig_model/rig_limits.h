#pragma once

#include <cmath>
#include <cstddef>

namespace fascia {

// What one file of a rig may hold, whatever its format: more would only fill the memory.
inline constexpr std::size_t kMostRigVertices = 4'000'000;
inline constexpr std::size_t kMostRigCorners = 6 * kMostRigVertices;  // of triangles
inline constexpr std::size_t kMostRigJoints = 20'000;                 // 16 bits number them
inline constexpr std::size_t kMostRigMorphs = 4096;
inline constexpr std::size_t kMostMorphNumbers = 300'000'000;           // of all their vertices
inline constexpr std::size_t kMostPictureBytes = std::size_t{1} << 30;  // of all materials

// Finite, and of a size that can be computed with: squares and products of some stay far from
// overflow in float.
inline bool isSane(double value) {
  constexpr double kLargest = 1e12;
  return std::isfinite(value) && std::abs(value) < kLargest;
}

}  // namespace fascia
