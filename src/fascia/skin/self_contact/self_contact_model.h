#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/geometry/box_tree.h>
#include <fascia/skin/point/point_kernels.h>

namespace fascia {

using IndexArray = std::vector<std::int32_t, AlignedAllocator<std::int32_t>>;

// Lists of different lengths, one after the other.
template <class T>
struct Lists {
  std::vector<std::uint32_t> first{0};  // one more than there are lists
  std::vector<T> items;

  std::size_t size() const { return first.size() - 1; }
  std::span<const T> operator[](std::size_t list) const {
    return {items.data() + first[list], items.data() + first[list + 1]};
  }
  void endList() { first.push_back(static_cast<std::uint32_t>(items.size())); }
};

// What of a skin may touch what, prepared once from the rest shape. Constant.
struct SelfContactModel {
  // Kernels work on this many at once, or on parts of it.
  static constexpr std::size_t kLanes = 16;
  // Points that lie together and look the same way; filled up by repeating the last one.
  struct Patch {
    static constexpr std::size_t kCapacity = 32;             // two of the widest vectors
    alignas(64) std::array<std::int32_t, kCapacity> points;  // storage indices
    std::uint32_t count;
  };
  // A run of triangles that lie together: those around one patch. Filled up to whole vectors by
  // repeating its last triangle.
  struct Group {
    static constexpr std::size_t kCapacity = 80;  // 32 points of a mesh have about 64 triangles
    std::uint32_t first, count;                   // multiples of kLanes
    float deepest_m;                              // largest of depth_m
    float ahead_m;                                // nothing farther in front is looked at
  };
  // How near a point may come to a group's triangles, where that is less than the gap.
  struct RestDistance {
    std::uint32_t group;
    float keep_m;
  };
  // Points of a patch that cross a group in the rest shape, bit by bit.
  struct LeftAlone {
    std::uint32_t group, lanes;
  };

  float gap_m = 0.002f;  // distance that is kept between two sheets of skin, at most
  float deepest_m = 0;   // largest of the groups'

  std::vector<Patch> patches;  // of all points that are tested

  std::vector<Group> groups;
  std::array<IndexArray, 3> corners;  // per triangle, group by group: storage indices
  FloatArray depth_m;                 // per triangle: points deeper below it have not come
                                      // through it, but through the other side of a thin limb

  std::size_t points = 0;          // storage
  FloatArray area_m2;              // per point
  FloatArray edge_m;               // per point: mean length of its edges
  FloatArray pointGap_m;           // per point: gap_m, or less where the skin is dense
  FloatArray roughAtRest_m;        // per point: its distance from the mean of its neighbours
  Lists<std::uint32_t> neighbors;  // per point: those joined to it by an edge
  // The triangles around kLanes points at a time, slot by slot; the number of all triangles where a
  // point has no more.
  Lists<std::int32_t> fans;
  Lists<std::uint32_t> nearPoints;  // per point: too near on the surface to touch; itself included
  Lists<RestDistance> restDistances;  // per point, sorted by group
  Lists<LeftAlone> leftAlone;         // per patch, sorted by group
  BoxTree tree;                       // of the groups in the rest shape

  std::size_t triangleCount() const { return depth_m.size(); }
  std::array<std::uint32_t, 3> triangle(std::size_t t) const {
    return {static_cast<std::uint32_t>(corners[0][t]), static_cast<std::uint32_t>(corners[1][t]),
            static_cast<std::uint32_t>(corners[2][t])};
  }
};

// `triangles` hold storage indices into `rest`, counter-clockwise from outside; every point is in
// at most one block. Points in no block are not moved, but triangles with such corners are
// obstacles.
SelfContactModel prepareSelfContact(std::span<const std::array<std::uint32_t, 3>> triangles,
                                    const VectorArray& rest, const std::vector<PointBlock>& blocks,
                                    float gap_m);

}  // namespace fascia
