#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include <fascia/base/ids.h>
#include <fascia/deformable/puppet/keyframed_path.h>

namespace fascia {

class Puppet;
using PuppetPointId = Id<struct PuppetPointTag>;
using BehaviourId = Id<struct BehaviourTag>;

// What a point goes for: another point, or a place (m).
using Target = std::variant<PuppetPointId, Vec3>;

enum class Progress {
  running,
  done,
  failed,  // a newer control took its point, or its time was up
};

// Something that a puppet does by itself, over time (Witkin & Welch 1990, §4.2). A behaviour has a
// goal, not a course: it looks at the puppet before every step and so succeeds from many states.
class Behaviour {
 public:
  virtual ~Behaviour() = default;

  // Throws Error if the puppet lacks what the behaviour needs; before the first update().
  virtual void check(const Puppet&) const {}
  // Before each step, of the length h_s. What follows a behaviour that is done may start before the
  // same step. Does not throw.
  virtual Progress update(Puppet& puppet, double h_s) = 0;
  // Half-way: lets go of what the behaviour controls.
  virtual void cancel(Puppet&) {}
};

using BehaviourPtr = std::unique_ptr<Behaviour>;

// Steps of the length h_s from now until `end_s` is reached; rounding does not make one more.
int stepsUntil(double end_s, double now_s, double h_s);

// Makers throw Error for numbers out of their ranges.

struct ChaseOptions {
  double duration_s = 1;  // (0, 1e6]; ends with the step in which this is over
  // In the world, on arrival. By default that of the cubic without acceleration at its end,
  //     v = v_target + (3/2) d/T − (1/2) (v_point − v_target)
  // with the distance d and the time T that are left: of all ways to be there in time the one with
  // the least ∫|a|² dt, whatever frame it is seen from.
  std::optional<Vec3> finalVelocity_m_per_s = {};
  bool keepControl = false;  // at the end: flies on straight, or stays if it has arrived at rest
};
// Along a cubic to where the target will be if it goes on straight; planned anew in every step.
BehaviourPtr makeChase(PuppetPointId point, const Target& target, const ChaseOptions& options);
// Chases, and connects on arrival.
BehaviourPtr makeGrab(PuppetPointId point, const Target& target, const ChaseOptions& options);
// To a place, at rest and held there; with a final velocity it is let go there.
BehaviourPtr makeMove(PuppetPointId point, const Vec3& place_m, const ChaseOptions& options);

struct FollowOptions {
  // Before the path starts the point is led from where it is to the path, in place and velocity:
  // the paper's preroll. 0 = the velocity jumps, by an impulse.
  double preroll_s = 0.25;  // [0, 1e6]
  // Simulated time at which the path starts; until its preroll the point is free. By default the
  // preroll begins at once.
  std::optional<double> onset_s = {};
};
// If the path ends at rest, the point is held there, otherwise let go.
BehaviourPtr makeFollow(PuppetPointId point, KeyframedPath path, const FollowOptions& options = {});

// Of no duration.
BehaviourPtr makeConnect(PuppetPointId point, const Target& target);
BehaviourPtr makeHold(PuppetPointId point);
BehaviourPtr makeRelease(PuppetPointId point);
BehaviourPtr makeStop(PuppetPointId point);

BehaviourPtr makeWait(double duration_s);  // [0, 1e9]
// Until the predicate holds, which is asked before every step. With a timeout it may fail.
using Predicate = std::function<bool(const Puppet&)>;
BehaviourPtr makeWaitFor(Predicate predicate, std::optional<double> timeout_s = {});

// All at once, in this order before each step; done when all are, failed if one has.
BehaviourPtr makeParallel(std::vector<BehaviourPtr> behaviours);
// One after the other, until one fails.
BehaviourPtr makeSequence(std::vector<BehaviourPtr> behaviours);

// parallel(makeChase(…), makeWait(…)), sequence(…): the same without a vector.
template <class... Behaviours>
std::vector<BehaviourPtr> behaviourList(Behaviours... behaviours) {
  std::vector<BehaviourPtr> list;
  (list.push_back(std::move(behaviours)), ...);
  return list;
}
template <class... Behaviours>
BehaviourPtr parallel(Behaviours... behaviours) {
  return makeParallel(behaviourList(std::move(behaviours)...));
}
template <class... Behaviours>
BehaviourPtr sequence(Behaviours... behaviours) {
  return makeSequence(behaviourList(std::move(behaviours)...));
}

}  // namespace fascia
