#pragma once

#include <span>
#include <string_view>
#include <vector>

#include <fascia/flesh/flesh.h>
#include <fascia/flesh/morphs.h>
#include <fascia/skeleton/skeleton.h>

namespace fascia {

// What a source moves. Borrowed: all parts must outlive whoever is given it.
struct Figure {
  const Skeleton& skeleton;
  const Flesh& flesh;
  const Morphs& morphs;
};

// What a source says about one moment.
struct PostureSample {
  // Every value and its rate, the derivative by time. Where a joint has a rotation its angles need
  // not be set: Skeleton::resolveRotations() does it.
  Posture posture;
  // Solid parameters that are animated; rates and weights' rates likewise.
  std::vector<Flesh::ParameterOverride> parameters;
  // By morph; those that are missing rest.
  MorphPose morphs{};
};

// Whatever moves a character: a clip, a blend of others, a hand, a live stream. It is made for one
// figure.
class PostureSource {
 public:
  virtual ~PostureSource() = default;

  // The posture at any time, also before the last one that was asked for. A function of time alone
  // until somebody changes the source between two frames. Replaces all that `out` held, but for
  // morphs, which rest when it is asked: a source that knows of none need not mind them. Allocates
  // nothing after the first calls with the same `out`; never throws. A source that needs memory of
  // its own keeps it: such are for one thread at a time.
  virtual void sample(double time_s, PostureSample& out) const = 0;

  // What a recording of it is called and how long it is; nothing is known of one without an end.
  struct Info {
    std::string_view name;  // empty: no motion of the character
    double duration_s = 0;  // 0: without an end
    bool loop = false;
  };
  virtual Info info() const { return {}; }
};

// Makes what a source said fit for posing, whatever it said: rotations resolved near the angles of
// a former posture (empty: near those of rest), values and weights within limits, no parameter of a
// solid and no weight of a morph that there is not.
void admit(const Figure& figure, const Posture& former, PostureSample& sample);
// Asks a source, with morphs at rest.
void ask(const PostureSource& source, double time_s, PostureSample& out);
// … and makes fit what it said, near the angles of rest.
void sampleFit(const PostureSource& source, const Figure& figure, double time_s,
               PostureSample& out);

}  // namespace fascia
