#pragma once

#include <fascia/render/pixels.h>

namespace fascia {

// A part of a picture: columns [left, right), rows [top, bottom) from the top.
struct PixelBox {
  int left = 0, top = 0, right = 0, bottom = 0;
};

// Takes the stairs off edges in a part of a picture that has one sample per pixel: pixels at an
// edge take as much of what is across it as the slanted line between the stairs' ends covers. What
// has no edge, and edges along rows and columns, keep their bytes. Throws Error if the picture has
// not as many bytes as its size says.
void smoothEdges(Pixels& picture, const PixelBox& box);

}  // namespace fascia
