#include <array>
#include <utility>

#include <fascia/base/suggest.h>
#include <fascia/world/script_call.h>

// Functions that come back when what they began is done.

namespace fascia {
namespace {

ChaseOptions chaseOptions(const ScriptCall& call) {
  ChaseOptions options{.duration_s = call.number(3, kDuration_s)};
  if (call.has(4)) options.finalVelocity_m_per_s = call.vector(4);
  return options;
}

int grab(ScriptCall& call) {
  const PuppetPointId point = call.bodyPoint(1);
  const Target target = call.target(2);
  call.checkTies();
  return call.waitFor(makeGrab(point, target, chaseOptions(call)));
}

int chase(ScriptCall& call) {
  const PuppetPointId point = call.bodyPoint(1);
  const Target target = call.target(2);
  return call.waitFor(makeChase(point, target, chaseOptions(call)));
}

int move(ScriptCall& call) {
  const PuppetPointId point = call.bodyPoint(1);
  const Vec3 place = call.puppet().position_m(call.target(2));
  return call.waitFor(makeMove(point, place, chaseOptions(call)));
}

// Pushes the field of the table at `index`, by its name or else by its number (0: none).
int pushField(lua_State* L, int index, const char* name, int number) {
  const int type = lua_getfield(L, index, name);
  if (type != LUA_TNIL || number == 0) return type;
  lua_pop(L, 1);
  return lua_rawgeti(L, index, number);
}

void checkNames(lua_State* L, int index, const std::string& what,
                std::span<const char* const> known) {
  lua_pushnil(L);
  while (lua_next(L, index) != 0) {
    lua_pop(L, 1);
    if (lua_type(L, -1) != LUA_TSTRING) continue;
    const std::string name = lua_tostring(L, -1);
    if (std::ranges::find(known, name) != known.end()) continue;
    Issue issue{
        {}, what + ": found the unknown field " + quotedName(name), didYouMean(name, known)};
    throw Error(issue);
  }
}

PathKey readKey(const ScriptCall& call, int index, const std::string& what) {
  constexpr std::array kFields{"time", "at", "velocity", "velocity_out"};
  lua_State* L = call.L;
  if (lua_type(L, index) != LUA_TTABLE) refuseValue(L, index, what, "{time, place}");
  checkNames(L, index, what, kFields);
  PathKey key;
  pushField(L, index, "time", 1);
  key.time_s = call.numberAt(-1, what + ": time", {-1e6, 1e6});
  pushField(L, index, "at", 2);
  key.position_m = call.vectorAt(-1, what + ": at");
  if (pushField(L, index, "velocity", 3) != LUA_TNIL)
    key.velocityIn_m_per_s = call.vectorAt(-1, what + ": velocity");
  if (pushField(L, index, "velocity_out", 4) != LUA_TNIL)
    key.velocityOut_m_per_s = call.vectorAt(-1, what + ": velocity_out");
  lua_pop(L, 4);
  return key;
}

std::vector<PathKey> readKeys(const ScriptCall& call, int index) {
  lua_State* L = call.L;
  if (lua_type(L, index) != LUA_TTABLE)
    refuseValue(L, index, "keys", "a list such as {{0, {0, 1}}, {0.5, {1, 1}}}");
  constexpr lua_Unsigned kMostKeys = 1000;
  std::vector<PathKey> keys;
  if (lua_rawlen(L, index) > kMostKeys)
    throw Error("keys: found more than " + std::to_string(kMostKeys));
  const auto count = static_cast<lua_Integer>(lua_rawlen(L, index));
  call.host.charge(L, 20 * count);
  for (lua_Integer i = 1; i <= count; ++i) {
    lua_rawgeti(L, index, i);
    keys.push_back(readKey(call, lua_gettop(L), "keys[" + std::to_string(i) + "]"));
    lua_pop(L, 1);
  }
  return keys;
}

FollowOptions readOptions(const ScriptCall& call, int index) {
  constexpr std::array kFields{"preroll", "onset"};
  lua_State* L = call.L;
  FollowOptions options;
  if (!call.has(index)) return options;
  if (lua_type(L, index) != LUA_TTABLE) refuseValue(L, index, "options", "{preroll = seconds}");
  checkNames(L, index, "options", kFields);
  if (pushField(L, index, "preroll", 0) != LUA_TNIL)
    options.preroll_s = call.numberAt(-1, "preroll", {0, 1e6});
  if (pushField(L, index, "onset", 0) != LUA_TNIL)
    options.onset_s = call.numberAt(-1, "onset", kAnySign);
  lua_pop(L, 2);
  return options;
}

int follow(ScriptCall& call) {
  const PuppetPointId point = call.bodyPoint(1);
  KeyframedPath path(readKeys(call, 2));
  return call.waitFor(makeFollow(point, std::move(path), readOptions(call, 3)));
}

int wait(ScriptCall& call) {
  // At least until the next step, so that a loop with a wait always goes on over time.
  const double seconds = std::max(call.number(1, {0, 1e6}), call.host.step_s());
  return call.waitFor(makeWait(seconds));
}

int askPredicate(lua_State* L);

int afterPredicate(lua_State* L, int, lua_KContext) {
  ScriptHost& host = ScriptHost::of(L);
  const bool holds = lua_toboolean(L, -1) != 0;
  const bool over = !lua_isnil(L, 2) &&
                    stepsUntil(lua_tonumber(L, 2), host.puppet().time_s(), host.step_s()) == 0;
  if (holds || over) {
    lua_pushboolean(L, holds ? 1 : 0);
    return 1;
  }
  host.current().waitsForStep = true;
  return lua_yieldk(L, 0, 0,
                    [](lua_State* thread, int, lua_KContext) { return askPredicate(thread); });
}

// 1: the predicate, 2: the time when to give up or nil. Called in the task, so that what is wrong
// with it is found where it is.
int askPredicate(lua_State* L) {
  lua_settop(L, 2);
  lua_pushvalue(L, 1);
  lua_callk(L, 0, 1, 0, afterPredicate);
  return afterPredicate(L, LUA_OK, 0);
}

int waitForPredicate(ScriptCall& call) {
  call.checkFunction(1);
  lua_settop(call.L, 2);
  if (call.has(2)) {
    lua_pushnumber(call.L, call.puppet().time_s() + call.number(2, {0, 1e6}));
    lua_replace(call.L, 2);
  }
  return askPredicate(call.L);
}

int parallelTasks(ScriptCall& call) {
  const int count = call.count();
  for (int i = 1; i <= count; ++i) call.checkFunction(i);
  std::vector<int> children;
  for (int i = 1; i <= count; ++i) children.push_back(call.host.startTask(call.L, i));
  call.host.current().children = std::move(children);
  return lua_yield(call.L, 0);
}

constexpr std::string_view kArrived =
    "whether it got there; a newer call for the same point ends an older one";
constexpr ScriptParameter kSeconds{"seconds", "number", "how long it takes"};

}  // namespace

std::span<const ScriptFunction> behaviourFunctions() {
  static const std::vector<ScriptFunction> kFunctions = {
      {"grab",
       {kPointParameter,
        {"target", "target", "another point, which may move, or a place"},
        kSeconds,
        {"velocity", "place", "of the point on arrival, m/s; by default one that is easy to reach",
         true}},
       "boolean",
       kArrived,
       "Chases the target and connects to it on arrival.",
       grab},
      {"chase",
       {kPointParameter,
        {"target", "target", "another point, which may move, or a place"},
        kSeconds,
        {"velocity", "place", "of the point on arrival, m/s; by default one that is easy to reach",
         true}},
       "boolean",
       kArrived,
       "Takes the point to where the target will be, and lets it fly on from there.",
       chase},
      {"move",
       {kPointParameter,
        {"place", "target", "where to; of a moving point, where it is now"},
        kSeconds,
        {"velocity", "place", "on arrival, m/s; the point is let go then", true}},
       "boolean",
       kArrived,
       "Takes the point to a place and holds it there.",
       move},
      {"follow",
       {kPointParameter,
        {"keys", "key[]", "places at growing times, in seconds after the onset"},
        {"options", "follow_options", "preroll and onset", true}},
       "boolean",
       "whether it went all the way",
       "Leads the point along a smooth path through keys; holds it at the end if the path ends at "
       "rest, otherwise lets it go. Before, a preroll takes it from where it is to the path.",
       follow},
      {"wait", {{"seconds", "number", "0 waits for the next step"}}, "", "", "Waits.", wait},
      {"wait_for",
       {{"condition", "fun(): boolean", "asked before every step"},
        {"timeout", "number", "seconds after which it gives up", true}},
       "boolean",
       "whether the condition holds",
       "Waits until a condition holds.",
       waitForPredicate},
      {"parallel",
       {{"functions", "fun()", "what to do", false, true}},
       "",
       "",
       "Runs functions at the same time, and waits until all have ended.",
       parallelTasks},
  };
  return kFunctions;
}

}  // namespace fascia
