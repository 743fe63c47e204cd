#pragma once

#include <vector>

#include <fascia/skin/grid/grid_layout.h>

namespace fascia {

// Which rows and columns of a grid a coarser level of it has, ascending from 0.
struct GridLines {
  std::vector<int> columns, rows;
};

// The grid itself, then every second row and column of the level before it, and the last ones:
// what a border is held by, each level has to feel. Ends with a level that has no more than
// `fewest` rows or columns.
std::vector<GridLines> gridLevels(const GridLayout& layout, std::size_t fewest);

// The line after the i-th; after the last column of a tube the first, counted on.
inline int lineAfter(const std::vector<int>& lines, std::size_t i, int count) {
  return i + 1 < lines.size() ? lines[i + 1] : count;
}

}  // namespace fascia
