#include <fascia/flesh/driver_curve.h>

#include <algorithm>
#include <cmath>

#include <fascia/base/assert.h>

namespace fascia {

// Fritsch & Carlson 1980, "Monotone Piecewise Cubic Interpolation": start from the mean of the two
// secants, zero at extrema, then shrink each pair of slopes (α, β in units of the secant) into the
// circle α² + β² ≤ 9. Ours: the end slopes are zero, so that the rate has no jump where the curve
// meets its constant ends.
DriverCurve::DriverCurve(const std::vector<DriverDef::Point>& points,
                         DriverDef::Interpolation interpolation)
    : smooth_(interpolation == DriverDef::Interpolation::smooth) {
  FASCIA_ASSERT(
      !points.empty() && std::ranges::is_sorted(points, {}, &DriverDef::Point::jointValue),
      "points increase");
  for (const DriverDef::Point& point : points) {
    nodes_.push_back({point.jointValue, point.parameter, 0});
  }
  if (!smooth_) return;
  const auto secant = [&](std::size_t i) {
    return (nodes_[i + 1].parameter - nodes_[i].parameter) /
           (nodes_[i + 1].jointValue - nodes_[i].jointValue);
  };
  for (std::size_t i = 1; i + 1 < nodes_.size(); ++i) {
    const double before = secant(i - 1), after = secant(i);
    const bool extremum = before == 0 || after == 0 || std::signbit(before) != std::signbit(after);
    nodes_[i].slope = extremum ? 0 : 0.5 * (before + after);
  }
  for (std::size_t i = 0; i + 1 < nodes_.size(); ++i) {
    const double slope = secant(i);
    if (slope == 0) continue;  // flat between: both slopes are zero already
    const double radius = std::hypot(nodes_[i].slope, nodes_[i + 1].slope) / std::abs(slope);
    if (radius <= 3) continue;
    nodes_[i].slope *= 3 / radius;
    nodes_[i + 1].slope *= 3 / radius;
  }
}

DriverCurve::Sample DriverCurve::at(double jointValue) const {
  FASCIA_ASSERT(!nodes_.empty(), "a curve has points");
  const auto right =
      std::upper_bound(nodes_.begin(), nodes_.end(), jointValue,
                       [](double value, const Node& node) { return value < node.jointValue; });
  if (right == nodes_.begin()) return {right->parameter, 0};
  const Node& a = *(right - 1);
  if (right == nodes_.end()) return {a.parameter, 0};
  const Node& b = *right;
  const double h = b.jointValue - a.jointValue, rise = b.parameter - a.parameter;
  const double s = (jointValue - a.jointValue) / h;
  if (!smooth_) return {a.parameter + s * rise, rise / h};
  const double m0 = h * a.slope, m1 = h * b.slope;  // cubic Hermite
  const double c2 = 3 * rise - 2 * m0 - m1, c3 = m0 + m1 - 2 * rise;
  return {a.parameter + s * (m0 + s * (c2 + s * c3)), (m0 + s * (2 * c2 + s * 3 * c3)) / h};
}

}  // namespace fascia
