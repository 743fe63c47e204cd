#pragma once

#include <string_view>

#include <fascia/math/types.h>
#include <fascia/render/pixels.h>

namespace fascia {

// What is drawn over pictures: letters, boxes, rings. Pixels, x to the right, y down; edges are
// smooth. What falls outside of the picture is left out.

// sRGB in [0, 1], and how much of it covers what is below.
struct Ink {
  Eigen::Vector3f color{1, 1, 1};
  float opacity = 1;
};

struct TextStyle {
  double size = 16;       // of the line; capitals are 0.7 of it tall
  double weight = 0.095;  // thickness of the pen over the size: 0.07 thin, 0.13 bold
  Ink ink;
};

// How far a text (UTF-8) reaches to the right of where it starts.
double textWidth(std::string_view text, const TextStyle& style);
// Its letters stand on `baseline`. Returns where it ends.
double drawText(Pixels& picture, double x, double baseline, std::string_view text,
                const TextStyle& style);

struct Rectangle {
  double x = 0, y = 0, width = 0, height = 0;
};
void fillBox(Pixels& picture, const Rectangle& box, const Ink& ink, double cornerRadius = 0);

// A circle's line, on both sides of its radius.
void drawRing(Pixels& picture, double x, double y, double radius, double thickness, const Ink& ink);

// Copies a picture into another, its top left corner at (x, y). It must fit.
void place(const Pixels& piece, int x, int y, Pixels& picture);
// … or only its left columns.
void placeColumns(const Pixels& piece, int columns, int x, int y, Pixels& picture);

}  // namespace fascia
