#pragma once

#include <vector>

#include <fascia/skin/grid/elastic_grid.h>
#include <fascia/skin/point/stretch_limit.h>

namespace fascia {

// The levels of a StretchLimit for a grid whose edges may grow to maxStretch times what they are in
// the rest shape: every second row and column of the level below, and the last.
std::vector<StretchLimit::Level> gridStretchLimits(const ElasticGrid& grid, float maxStretch);

}  // namespace fascia
