#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/math/types.h>

namespace fascia {

// A plain indexed triangle mesh, counter-clockwise seen from outside. Optional arrays are empty or
// as long as positions.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> positions;  // metres
  std::vector<Eigen::Vector3f> normals;    // unit
  std::vector<Eigen::Vector2f> uvs;        // (0,0) = top left of the picture, as in glTF
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// Area-weighted vertex normals of triangles, written to `normals` (unit; +y where undefined).
void computeNormals(const std::vector<Eigen::Vector3f>& positions,
                    const std::vector<std::array<std::uint32_t, 3>>& triangles,
                    std::vector<Eigen::Vector3f>& normals);

// Every edge both ways, as often as triangles run along it; increasing.
std::vector<std::array<std::uint32_t, 2>> edgesBothWays(
    std::span<const std::array<std::uint32_t, 3>> triangles);

// Enclosed volume of a closed mesh by the divergence theorem.
double enclosedVolume(const TriangleMesh& mesh);

}  // namespace fascia
