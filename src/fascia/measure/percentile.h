#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace fascia {

// The nearest rank: the smallest of the values that at least `share` of all do not exceed. The
// values must not be empty; their order changes.
inline double percentile(std::vector<double>& values, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

}  // namespace fascia
