#pragma once

namespace fascia {

// full: soft shadows, occlusion, light inside of skin. fast: for what moves in a window on a
// machine without a graphics card; matt light and one hard shadow, one sample per pixel with its
// edges smoothed, the same shapes and colours.
enum class Look { full, fast };

}  // namespace fascia
