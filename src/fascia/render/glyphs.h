#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace fascia {

// A letter as a pen writes it, on a grid: 70 units from the baseline to the top of capitals, 50 to
// the top of small letters, x to the right, y up.
struct Glyph {
  struct Line {
    Eigen::Vector2f from, to;
  };
  std::vector<Line> lines;
  float width = 0;  // of the ink; what stands between letters is not in it
};

// The letter of a Unicode character; a box for what there is none of. Valid forever.
const Glyph& glyphOf(char32_t character);

}  // namespace fascia
