#include <fascia/motion/clip.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

struct Tangents {
  double in, out;  // per second
};

// Kochanek & Bartels 1984, "Interpolating Splines with Local Tension, Continuity, and Bias
// Control":
//   DS_i = (1-t)(1-c)(1+b)/2 (P_i - P_{i-1}) + (1-t)(1+c)(1-b)/2 (P_{i+1} - P_i)   incoming
//   DD_i = (1-t)(1+c)(1+b)/2 (P_i - P_{i-1}) + (1-t)(1-c)(1-b)/2 (P_{i+1} - P_i)   outgoing
// per interval of unit length. For keys that are not evenly spaced the paper scales the two so that
// the speed is the same on both sides of the key: multiplied by 2 h / (h_{i-1} + h_i), where h is
// the interval on the tangent's own side. Per second that is 2 / (h_{i-1} + h_i) on both sides: all
// zero gives the slope of the chord from the key before to the key after. (Averaging the two slopes
// instead would let a short steep interval throw the curve far beyond a long flat one.)
Tangents innerTangents(const Key& before, const Key& key, const Key& after) {
  const double t = key.tension, c = key.continuity, b = key.bias;
  const double rise = key.value - before.value, fall = after.value - key.value;
  const double scale = (1 - t) / (after.time_s - before.time_s);
  return {scale * ((1 - c) * (1 + b) * rise + (1 + c) * (1 - b) * fall),
          scale * ((1 + c) * (1 + b) * rise + (1 - c) * (1 - b) * fall)};
}

// At an end the curve meets a constant: at rest, but for a negative continuity. The paper leaves
// end tangents open.
double endTangent(const Key& end, const Key& neighbour) {
  const double slope = (neighbour.value - end.value) / (neighbour.time_s - end.time_s);
  return std::max(0.0, -end.continuity) * (1 - end.tension) * slope;
}

}  // namespace

KeySpline::KeySpline(std::vector<Key> keys, double period_s) {
  if (keys.empty()) return;
  const bool periodic = period_s > 0;
  // Times like 0.1 * 40 miss a period of 4 by rounding only; without the tolerance the curve would
  // get a segment of 1e-16 s there.
  const auto closes = [&](const Key& key) {
    return key.time_s - keys.front().time_s >= period_s * (1 - 1e-9);
  };
  while (periodic && keys.size() > 1 && closes(keys.back())) keys.pop_back();
  const std::size_t n = keys.size();
  period_s_ = periodic && n > 1 ? period_s : 0;

  const auto shifted = [&](std::size_t i, double time_s) {
    Key key = keys[i];
    key.time_s += time_s;
    return key;
  };
  knots_.reserve(n + 1);
  for (std::size_t i = 0; i < n; ++i) {
    Tangents d{0, 0};
    if (period_s_ > 0) {
      const Key before = i > 0 ? keys[i - 1] : shifted(n - 1, -period_s_);
      d = innerTangents(before, keys[i], i + 1 < n ? keys[i + 1] : shifted(0, period_s_));
    } else if (i > 0 && i + 1 < n) {
      d = innerTangents(keys[i - 1], keys[i], keys[i + 1]);
    } else if (n > 1) {
      d.out = i == 0 ? endTangent(keys[0], keys[1]) : 0;
      d.in = i > 0 ? endTangent(keys[i], keys[i - 1]) : 0;
    }
    knots_.push_back({keys[i].time_s, keys[i].value, d.in, d.out});
  }
  if (period_s_ > 0) {
    knots_.push_back(knots_.front());
    knots_.back().time_s += period_s_;
  }
}

// Cubic Hermite: values and tangents at both ends.
SplineSample KeySpline::between(const Knot& a, const Knot& b, double time_s) {
  FASCIA_ASSERT(time_s >= a.time_s && time_s <= b.time_s, "the time lies between the knots");
  const double h = b.time_s - a.time_s;
  const double s = (time_s - a.time_s) / h;
  const double rise = b.value - a.value, m0 = h * a.out, m1 = h * b.in;
  const double c2 = 3 * rise - 2 * m0 - m1, c3 = m0 + m1 - 2 * rise;
  return {a.value + s * (m0 + s * (c2 + s * c3)), (m0 + s * (2 * c2 + s * 3 * c3)) / h};
}

SplineSample KeySpline::at(double time_s) const {
  if (knots_.empty()) return {};
  if (!std::isfinite(time_s)) return {knots_.front().value, 0};
  if (period_s_ > 0) {
    const double start_s = knots_.front().time_s;
    time_s -= period_s_ * std::floor((time_s - start_s) / period_s_);
  }
  // Rounding may leave a wrapped time a hair outside: clamp to the first and last knot.
  const auto after = std::upper_bound(knots_.begin(), knots_.end(), time_s,
                                      [](double t, const Knot& knot) { return t < knot.time_s; });
  if (after == knots_.begin()) {
    return {knots_.front().value, period_s_ > 0 ? knots_.front().out : 0};
  }
  if (after == knots_.end()) return {knots_.back().value, period_s_ > 0 ? knots_.back().out : 0};
  return between(*(after - 1), *after, time_s);
}

}  // namespace fascia
