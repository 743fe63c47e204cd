#pragma once

#include <string>

#include <fascia/render/pixels.h>

#include "compare/layout.h"
#include "compare/survey.h"

namespace fascia {

// Where a place is seen in a main picture: in [0, 1] of it, the radius in its heights.
struct Mark {
  double x, y, radius;
};

// What is written on a picture of two sides.
struct SheetText {
  Both<std::string> names;
  std::string title;  // of the moment
};

// Puts pictures into a layout and writes on them.
class Sheet {
 public:
  Sheet(Layout layout, SheetText text);

  const Layout& layout() const { return layout_; }
  void setTitle(std::string title) { text_.title = std::move(title); }

  void begin(Pixels& picture) const;
  // Marks the pictures too.
  void addMain(Both<Pixels>& pictures, const Both<std::vector<Mark>>& marks, double wipe,
               Pixels& picture) const;
  void addCloser(std::size_t place, Side side, const Pixels& piece, Pixels& picture) const;
  void addFigures(const Moment& moment, Pixels& picture) const;

 private:
  void addMarks(std::span<const Mark> marks, Pixels& picture) const;
  void addName(const Cell& cell, Side side, bool right, Pixels& picture) const;

  Layout layout_;
  SheetText text_;
};

}  // namespace fascia
