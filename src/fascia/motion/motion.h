#pragma once

#include <span>
#include <string>
#include <vector>

#include <fascia/base/error.h>

namespace fascia {

// A key of a Kochanek–Bartels spline (Kochanek & Bartels 1984). tension, continuity and bias in
// [-1, 1]; all zero gives Catmull–Rom.
struct Key {
  double time_s = 0;
  double value = 0;  // metre or radian; a solid's parameter: its own unit
  double tension = 0, continuity = 0, bias = 0;
};

// One animated number: a joint's degree of freedom or a solid's parameter.
struct TrackDef {
  enum class Target { joint, solid };
  Target target = Target::joint;
  std::string name;     // of the joint or solid
  std::string channel;  // "tx"…"rz", or the parameter's name, e.g. "radius_m"
  std::vector<Key> keys;
};

struct MotionDef {
  std::string name;
  double duration_s = 0;  // 0 = the last key's time
  bool loop = false;      // the last key's posture equals the first's; tangents wrap
  std::vector<TrackDef> tracks;
};

}  // namespace fascia
