#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/base/ids.h>

namespace fascia {

// Which points feel which solids, where not all feel all: on imported figures, whose limbs pass
// through each other and through the body in many a clip. Pairs of a point and a solid are kept by
// chunks of points, then by solid, so that a solid is asked for many points at once, whatever else
// these feel.
struct FleshSense {
  static constexpr std::size_t kChunk = 1024;  // points; one task, and its lanes fit a cache
  static constexpr std::size_t kPad = 16;      // floats of the widest vector

  struct Feeling {
    std::uint32_t point;  // storage index
    SolidId solid;
    // Whether other joints move the point too, so that the pose can drive the solid over it. What a
    // clip puts inside of another limb is not torn off: where the joints alone would carry it
    // deeper than its yield, the solid pushes its anchor less the deeper it is, and not beyond
    // three yields; the point itself may be as deep as its anchor is.
    bool yields;
  };
  // A chunk's pairs with one solid: those that yield are [first, firstFirm), the others
  // [firstFirm, end). Both parts are padded to whole vectors.
  struct Group {
    SolidId solid;
    std::uint32_t first, firstFirm, end;
  };
  struct Chunk {
    std::size_t firstPoint, points;
    std::size_t firstGroup, groups;
  };

  FleshSense() = default;
  // For points [0, yield_m.size()).
  FleshSense(std::vector<Feeling> feelings, std::size_t solidCount, FloatArray yield_m);

  std::size_t pairCount() const { return point.size(); }  // with pads

  std::vector<Chunk> chunks;
  std::vector<Group> groups;
  std::vector<std::int32_t> point;  // per pair: less its chunk's first; of pads: kChunk
  FloatArray yield_m;               // per point
  std::size_t solids = 0;
};

}  // namespace fascia
