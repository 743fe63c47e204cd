#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <fascia/math/types.h>

namespace fascia {

// Part of readMakeHuman(): a Wavefront OBJ with its groups, as the base mesh needs them.
struct ObjMesh {
  struct Corner {
    std::uint32_t position = 0;
    std::int32_t uv = -1;  // -1: none
  };
  struct Group {
    std::string name;
    std::vector<Corner> corners;             // of all faces
    std::vector<std::uint32_t> faceCorners;  // how many of them each face has
  };
  std::vector<Vec3> positions;  // in the file's unit
  std::vector<Vec2> uvs;        // (0,0) = bottom left, as in the file
  std::vector<Group> groups;    // every name once

  const Group* find(std::string_view name) const;
};

// Positions, UVs, groups and faces; everything else is skipped. Throws Error with the line.
ObjMesh parseObj(std::string_view text, const std::string& file);

// The middle of a group's points. The group must not be empty.
Vec3 middleOf(const ObjMesh& mesh, const ObjMesh::Group& group);

}  // namespace fascia
