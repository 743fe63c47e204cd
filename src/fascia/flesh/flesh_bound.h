#pragma once

#include <vector>

#include <fascia/flesh/driver_curve.h>

namespace fascia {

// A driver bound to the indices of one character.
struct Flesh::Driver {
  int value;      // index into Posture::values
  int parameter;  // of the solid
  DriverCurve curve;
};

struct Flesh::Bound {
  std::vector<Solid> rest;  // one per solid
  std::vector<Driver> drivers;
};

}  // namespace fascia
