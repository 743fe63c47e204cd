#include <fascia/world/script_call.h>

// Functions that act on points at once.

namespace fascia {
namespace {

int connect(ScriptCall& call) {
  const PuppetPointId point = call.bodyPoint(1);
  const Target target = call.target(2);
  call.checkTies();
  call.puppet().connect(point, target);
  return 0;
}

int hold(ScriptCall& call) {
  call.puppet().hold(call.bodyPoint(1));
  return 0;
}

int release(ScriptCall& call) {
  const PuppetPointId point = call.bodyPoint(1);
  if (call.has(2)) {
    call.puppet().disconnect(point, call.bodyPoint(2));
  } else {
    call.puppet().release(point);
  }
  return 0;
}

int stop(ScriptCall& call) {
  call.puppet().stop(call.bodyPoint(1));
  return 0;
}

int impulse(ScriptCall& call) {
  call.puppet().impulse(call.bodyPoint(1), call.vector(2));
  return 0;
}

int push(ScriptCall& call) {
  const PuppetPointId point = call.bodyPoint(1);
  call.checkTies();
  call.puppet().push(point, call.vector(2), call.number(3, kDuration_s));
  return 0;
}

int pull(ScriptCall& call) {
  const PuppetPointId point = call.bodyPoint(1);
  const Target target = call.target(2);
  const double stiffness = call.number(3, {1e-6, 1e9});
  call.puppet().pull(point, target, stiffness, call.has(4) ? call.number(4, kNotNegative) : 0);
  return 0;
}

}  // namespace

std::span<const ScriptFunction> controlFunctions() {
  static const std::vector<ScriptFunction> kFunctions = {
      {"connect",
       {kPointParameter, {"target", "target", "a point of another body, or a place to nail it to"}},
       "",
       "",
       "Ties the point to the target: an impulse makes their velocities one, and what distance "
       "there is closes within a tenth of a second.",
       connect},
      {"hold", {kPointParameter}, "", "", "Holds the point where it is.", hold},
      {"release",
       {kPointParameter, {"other", "string", "only from this point", true}},
       "",
       "",
       "Lets the point go from everything that holds, leads, ties or pulls it; it flies on.",
       release},
      {"stop",
       {kPointParameter},
       "",
       "",
       "Stops the point dead by an impulse, and lets it go.",
       stop},
      {"impulse",
       {kPointParameter, {"impulse", "place", "N s"}},
       "",
       "",
       "A blow on the point.",
       impulse},
      {"push",
       {kPointParameter,
        {"force", "place", "N"},
        {"seconds", "number", "how long; the call does not wait"}},
       "",
       "",
       "Pushes the point with a force for a time.",
       push},
      {"pull",
       {kPointParameter,
        {"target", "target", "another point or a place; call again to move it"},
        {"stiffness", "number", "N/m"},
        {"damping", "number", "N s/m; 0 by default", true}},
       "",
       "",
       "Pulls the point to the target by a damped spring, until it is released.",
       pull},
  };
  return kFunctions;
}

}  // namespace fascia
