#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <fascia/base/error.h>
#include <fascia/base/tunable.h>

namespace fascia {

// A key of a Kochanek–Bartels spline (Kochanek & Bartels 1984). tension, continuity and bias in
// [-1, 1]; all zero gives Catmull–Rom.
struct Key {
  double time_s = 0;
  double value = 0;  // metre or radian; a solid's parameter: its own unit; a morph: its weight
  double tension = 0, continuity = 0, bias = 0;
  bool operator==(const Key&) const = default;
};
constexpr auto tunables(const Key*) {
  return std::tuple{
      tunable(&Key::time_s, "t_s", "s", {0, 1e6}, "When").required(),
      tunable(&Key::tension, "tension", "", {-1, 1}, "1: straight, -1: round"),
      tunable(&Key::continuity, "continuity", "", {-1, 1},
              "Not 0: a corner, out of or into the curve"),
      tunable(&Key::bias, "bias", "", {-1, 1}, "1: swings over after the key, -1: before it")};
}
// Of a key, in the solid parameter's own unit; for joints see kDofAngle and kDofShift.
inline constexpr TunableInfo kKeyValue{
    "value", "", {-1e6, 1e6}, "Of a solid's parameter, in its own unit"};

// One animated number: a joint's degree of freedom, a solid's parameter or a morph's weight.
struct TrackDef {
  enum class Target { joint, solid, morph };
  Target target = Target::joint;
  std::string name;     // of the joint, solid or morph
  std::string channel;  // "tx"…"rz", or the parameter's name, e.g. "radius_m"; of a morph: empty
  std::vector<Key> keys;  // times increase; at least one
  bool operator==(const TrackDef&) const = default;
};

struct MotionDef {
  std::string name;
  double duration_s = 0;
  bool loop = false;             // every duration; tangents wrap. See KeySpline.
  std::vector<TrackDef> tracks;  // at most kMostTracks
  bool operator==(const MotionDef&) const = default;
};
constexpr auto tunables(const MotionDef*) {
  return std::tuple{
      tunable(&MotionDef::loop, "loop", "Repeats; the last posture equals the first"),
      tunable(&MotionDef::duration_s, "duration_s", "s", {0, 1e6}, "0: the last key's time")};
}

// The duration that a motion plays for: its own, or the last key's time.
double playedDuration_s(const MotionDef& motion);

// More than any figure has numbers to animate; bounds what a hostile file can cost.
inline constexpr std::size_t kMostTracks = 8192;

// Reports everything that is wrong with a motion by itself; whether its joints and solids exist is
// for bindMotion (flesh/bind.h) to say. Pointers start with `pointer`, e.g. "/motions/0".
void validateMotion(const MotionDef& motion, const std::string& pointer, Diagnostics& diagnostics);

}  // namespace fascia
