#pragma once

#include <fascia/base/aligned.h>
#include <fascia/skin/grid/grid_layout.h>

namespace fascia {

// Change of resolution (Turner & Gobbetti 1998, §6.5): bilinear interpolation in material
// coordinates of any per-point quantity from one grid to another, finer or coarser. End rows map to
// end rows; a closed grid wraps. Values at material coordinates both grids share are kept exactly.
// Pads are filled.
FloatArray resample(const GridLayout& from, const FloatArray& values, const GridLayout& to);
VectorArray resample(const GridLayout& from, const VectorArray& values, const GridLayout& to);

}  // namespace fascia
