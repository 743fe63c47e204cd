#include <fascia/skin/grid/grid_lines.h>

#include <algorithm>
#include <numeric>

namespace fascia {
namespace {

std::vector<int> everySecondLine(const std::vector<int>& lines, bool closed) {
  std::vector<int> half;
  for (std::size_t i = 0; i < lines.size(); i += 2) half.push_back(lines[i]);
  if (!closed && half.back() != lines.back()) half.push_back(lines.back());
  return half;
}

std::vector<int> allLines(int count) {
  std::vector<int> lines(static_cast<std::size_t>(count));
  std::iota(lines.begin(), lines.end(), 0);
  return lines;
}

}  // namespace

std::vector<GridLines> gridLevels(const GridLayout& layout, std::size_t fewest) {
  std::vector<GridLines> levels{{allLines(layout.columns), allLines(layout.rows)}};
  while (std::min(levels.back().columns.size(), levels.back().rows.size()) > fewest)
    levels.push_back({everySecondLine(levels.back().columns, layout.closed),
                      everySecondLine(levels.back().rows, false)});
  return levels;
}

}  // namespace fascia
