#pragma once

#include <vector>

#include <fascia/flesh/flesh.h>

namespace fascia {

// A driver's parameter as a function of its joint value, made ready: constant outside its points.
// Monotone wherever its points are, so a swelling never overshoots.
class DriverCurve {
 public:
  struct Sample {
    double parameter;
    double slope;  // per joint value; to the right where a piecewise curve has a corner
  };

  DriverCurve() = default;
  // Points increase in jointValue; at least one.
  DriverCurve(const std::vector<DriverDef::Point>& points, DriverDef::Interpolation interpolation);
  Sample at(double jointValue) const;

 private:
  struct Node {
    double jointValue, parameter;
    double slope;  // smooth: of the curve at the node
  };
  std::vector<Node> nodes_;
  bool smooth_ = true;
};

}  // namespace fascia
