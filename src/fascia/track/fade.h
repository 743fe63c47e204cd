#pragma once

#include <algorithm>

namespace fascia {

// How much of something counts, and how fast that changes.
struct Share {
  double weight = 1;  // [0, 1]
  double rate_per_s = 0;
};

// A weight that goes smoothly from one value to another: its rate has no jumps.
struct Fade {
  double from = 1, to = 1;  // [0, 1]
  double start_s = 0;
  double duration_s = 0;  // 0: a step at start_s

  Share at(double time_s) const {
    if (from == to) return {to, 0};
    if (duration_s <= 0) return {time_s < start_s ? from : to, 0};
    const double s = std::clamp((time_s - start_s) / duration_s, 0.0, 1.0);
    return {from + (to - from) * s * s * (3 - 2 * s), (to - from) * 6 * s * (1 - s) / duration_s};
  }
};

}  // namespace fascia
