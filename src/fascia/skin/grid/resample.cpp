#include <fascia/skin/grid/resample.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>
#include <fascia/skin/grid/elastic_grid.h>

namespace fascia {
namespace {

struct Between {
  int low, high;
  double t;
};

// Where sample i of `count` lies among `samples`: periodic, or from end to end.
Between locate(int i, int count, int samples, bool periodic) {
  const double intervals = periodic ? samples : samples - 1;
  const double targets = periodic ? count : std::max(1, count - 1);
  const double x = i * intervals / targets;
  const int low = std::min(static_cast<int>(x), periodic ? samples - 1 : std::max(0, samples - 2));
  const int high = periodic ? (low + 1) % samples : std::min(low + 1, samples - 1);
  return {low, high, x - low};
}

}  // namespace

FloatArray resample(const GridLayout& from, const FloatArray& values, const GridLayout& to) {
  FASCIA_ASSERT(values.size() == from.storage(), "the values are of this grid");
  FloatArray out(to.storage(), 0.f);
  for (int j = 0; j < to.rows; ++j) {
    const Between v = locate(j, to.rows, from.rows, false);
    FASCIA_ASSERT(v.low >= 0 && v.high < from.rows, "between rows of the grid");
    for (int i = 0; i < to.columns; ++i) {
      const Between u = locate(i, to.columns, from.columns, from.closed);
      const auto row = [&](int r) {
        const double a = values[from.at(u.low, r)], b = values[from.at(u.high, r)];
        return a + u.t * (b - a);
      };
      const double a = row(v.low), b = row(v.high);
      out[to.at(i, j)] = static_cast<float>(a + v.t * (b - a));
    }
  }
  fillPads(to, out);
  return out;
}

VectorArray resample(const GridLayout& from, const VectorArray& values, const GridLayout& to) {
  VectorArray out;
  out.x = resample(from, values.x, to);
  out.y = resample(from, values.y, to);
  out.z = resample(from, values.z, to);
  return out;
}

}  // namespace fascia
