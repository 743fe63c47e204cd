#pragma once

#include <functional>
#include <vector>

namespace fascia {

// Chooses which of `count` frames to keep so that the others can be blended from their kept
// neighbours: blends(a, b) says whether every frame strictly between a and b can. The first and the
// last are always kept. Tries ever longer spans, so that a still motion costs little.
std::vector<std::size_t> keepFrames(std::size_t count,
                                    const std::function<bool(std::size_t, std::size_t)>& blends);

}  // namespace fascia
