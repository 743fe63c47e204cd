#pragma once

#include <array>
#include <functional>
#include <vector>

namespace fascia {

// A piece of a picture, in pixels from the top left.
struct Cell {
  int x = 0, y = 0, width = 0, height = 0;
  double aspect() const { return static_cast<double>(width) / height; }
};

// Where everything is in a picture of two sides.
struct Layout {
  int width = 0, height = 0;
  std::vector<Cell> mains;                  // whole figures, plain and ours; or one for both
  std::vector<std::array<Cell, 2>> closer;  // pairs: plain, ours
  Cell figures;                             // the lines of measures
  double text = 0;                          // size of letters
};

// The layout in which the figure is largest. distance: how far away the camera stands that shows a
// figure whole in a picture of this aspect.
Layout arrange(int width, int height, std::size_t places, bool wipe,
               const std::function<double(double aspect)>& distance);

}  // namespace fascia
