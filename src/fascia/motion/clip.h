#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <fascia/motion/motion.h>
#include <fascia/motion/sampled_motion.h>

namespace fascia {

// Value and time derivative of a spline.
struct SplineSample {
  double value = 0;
  double rate = 0;  // per second
};

// A Kochanek–Bartels spline through `keys` (sorted by time), made ready: tangents precomputed.
//
// Constant before the first and after the last key. There the value rests, so the tangent is zero
// and the rate has no jump; a negative continuity at an end key opens the corner (-1: the
// neighbouring segment's full slope).
//
// With period_s > 0 it repeats instead and the tangents wrap. A last key one period after the first
// is the first key again (its tension, continuity and bias do not count); a last key before that is
// joined to the first by a segment of its own.
class KeySpline {
 public:
  KeySpline() = default;
  KeySpline(std::vector<Key> keys, double period_s);
  SplineSample at(double time_s) const;  // a time that is not finite reads as the first key's

 private:
  struct Knot {
    double time_s, value;
    double in, out;  // tangents arriving and leaving, per second
  };
  static SplineSample between(const Knot& a, const Knot& b, double time_s);

  std::vector<Knot> knots_;  // periodic: ends with the first knot again, a period later
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
    KeySpline spline;
  };
  struct MorphTrack {
    std::size_t morph;  // in Morphs
    KeySpline spline;
  };
  std::string name;
  double duration_s = 0;
  bool loop = false;
  // A joint that a sampled motion moves. The motion's frames may stand otherwise in the joints than
  // the skeleton's do: local = before · sample · after gives the turn and shift from the rest.
  struct SampledJoint {
    std::size_t sample;      // index into SampledMotion::joints
    std::size_t firstValue;  // tx, ty, tz, rx, ry, rz in Posture::values
    Transform before, after;
  };
  std::vector<JointTrack> joints;
  std::vector<SolidTrack> solids;
  std::vector<MorphTrack> morphs;
  std::shared_ptr<const SampledMotion> sampled;  // may be null
  std::vector<SampledJoint> sampledJoints;
  struct SampledMorph {
    std::size_t sample;  // index into SampledMotion::morphs
    std::size_t morph;   // in Morphs
  };
  std::vector<SampledMorph> sampledMorphs;
};

}  // namespace fascia
