#pragma once

#include <cstdint>
#include <span>

#include <fascia/base/aligned.h>

namespace fascia {

// Edges from consecutive points to others that lie as far from them in storage each.
struct EdgeRun {
  std::uint32_t first = 0, count = 0;  // the points
  std::int32_t step = 0;               // to the other ends
  std::uint32_t longest = 0;           // where their limits start in a list
};

// Whether an edge is longer than (1 + share) times its limit (m); dispatched at run time. The same
// on every target, as nothing is fused.
bool anyEdgeExceeds(std::span<const EdgeRun> runs, const FloatArray& longest_m,
                    const VectorArray& position, float share);

}  // namespace fascia
