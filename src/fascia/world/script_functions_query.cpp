#include <fascia/world/script_call.h>

// Functions that tell something.

namespace fascia {
namespace {

int position(ScriptCall& call) {
  pushVector(call.L, call.puppet().position_m(call.anyPoint(1)));
  return 1;
}

int velocity(ScriptCall& call) {
  pushVector(call.L, call.puppet().velocity_m_per_s(call.anyPoint(1)));
  return 1;
}

int distance(ScriptCall& call) {
  lua_pushnumber(call.L, call.puppet().distance_m(call.target(1), call.target(2)));
  return 1;
}

int connected(ScriptCall& call) {
  const PuppetPointId a = call.bodyPoint(1), b = call.anyPoint(2);
  lua_pushboolean(call.L, call.puppet().connected(a, b) ? 1 : 0);
  return 1;
}

int time(ScriptCall& call) {
  lua_pushnumber(call.L, call.puppet().time_s());
  return 1;
}

int gravity(ScriptCall& call) {
  pushVector(call.L, call.puppet().gravity_m_per_s2());
  return 1;
}

int random(ScriptCall& call) {
  const double low = call.has(1) ? call.number(1, kAnySign) : 0,
               high = call.has(1) ? call.number(2, {low, kAnySign.high}) : 1;
  lua_pushnumber(call.L, call.host.random().uniform(low, high));
  return 1;
}

int vec(ScriptCall& call) {
  Vec3 v = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis)
    if (axis < 2 || call.has(3)) v[axis] = call.number(axis + 1, kAnySign);
  pushVector(call.L, v);
  return 1;
}

int log(ScriptCall& call) {
  const int count = call.count();
  std::string line;
  for (int i = 1; i <= count && line.size() <= ScriptHost::kLongestLine; ++i) {
    pushText(call.L, i);
    std::size_t length = 0;
    const char* text = lua_tolstring(call.L, -1, &length);
    line.append(i > 1 ? " " : "").append(text, length);
    lua_pop(call.L, 1);
  }
  call.host.log(std::move(line));
  return 0;
}

}  // namespace

std::span<const ScriptFunction> queryFunctions() {
  static const std::vector<ScriptFunction> kFunctions = {
      {"position", {{"point", "string", "any point"}}, "vec", "m", "Where a point is.", position},
      {"velocity", {{"point", "string", "any point"}}, "vec", "m/s", "How fast it is.", velocity},
      {"distance",
       {{"a", "target", "a point or a place"}, {"b", "target", "another one"}},
       "number",
       "m",
       "How far two points or places are apart.",
       distance},
      {"connected",
       {{"a", "string", "a point of a body"}, {"b", "string", "of another one, or a place"}},
       "boolean",
       "whether they are",
       "Tells whether connect() or grab() has tied two points, or one to a place.",
       connected},
      {"time", {}, "number", "s", "Simulated time since the start.", time},
      {"gravity", {}, "vec", "m/s²", "What the scene's gravity accelerates bodies by.", gravity},
      {"random",
       {{"low", "number", "0 by default", true}, {"high", "number", "1 by default", true}},
       "number",
       "between the two",
       "A random number; the seed of the run decides which.",
       random},
      {"vec",
       {{"x", "number", ""}, {"y", "number", ""}, {"z", "number", "0 by default", true}},
       "vec",
       "the vector",
       "A vector, with + - * / ==, fields x y z, and :length() :normalized() :dot(v) :cross(v).",
       vec},
      {"log",
       {{"values", "any", "what to write", false, true}},
       "",
       "",
       "Writes a line to the log of the run.",
       log},
  };
  return kFunctions;
}

std::span<const ScriptSection> scriptSections() {
  static const ScriptSection kSections[] = {
      {"Behaviours: calls that take time", behaviourFunctions()},
      {"Controls: calls that act at once", controlFunctions()},
      {"Tasks", taskFunctions()},
      {"What there is to know", queryFunctions()},
  };
  return kSections;
}

}  // namespace fascia
