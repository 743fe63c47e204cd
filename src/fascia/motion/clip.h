#pragma once

#include <cstddef>
#include <vector>

#include <fascia/motion/motion.h>

namespace fascia {

// Value and time derivative of a Kochanek–Bartels spline through `keys` (sorted by time).
struct SplineSample {
  double value = 0;
  double rate = 0;  // per second
};

// A spline made ready: tangents precomputed. Constant before the first and after the last key,
// or periodic with `period_s` when that is > 0.
class KeySpline {
 public:
  KeySpline() = default;
  KeySpline(std::vector<Key> keys, double period_s);
  SplineSample at(double time_s) const;

 private:
  std::vector<Key> keys_;
  std::vector<double> out_, in_;  // per key: outgoing and incoming tangent, per second
  double period_s_ = 0;
};

// A motion bound to one character's value indices.
struct BoundClip {
  struct JointTrack {
    int value;  // index into Posture::values
    KeySpline spline;
  };
  struct SolidTrack {
    int solid, parameter;  // SolidId and its parameter index
    bool ornament = false;
    KeySpline spline;
  };
  std::string name;
  double duration_s = 0;
  bool loop = false;
  std::vector<JointTrack> joints;
  std::vector<SolidTrack> solids;
};

}  // namespace fascia
