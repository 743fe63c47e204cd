#pragma once

#include <vector>

#include <fascia/skin/point/stretch_limit.h>

namespace fascia {

// The levels of a stretch limit for any surface, from its edges. A coarser level's points are a
// maximal independent set of the finer one's; those near each other are joined, by chords as long
// as the way along the edges between them.
std::vector<StretchLimit::Level> meshStretchLimits(std::vector<StretchLimit::Edge> edges);

}  // namespace fascia
