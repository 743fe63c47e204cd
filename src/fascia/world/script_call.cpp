#include <fascia/world/script_call.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <fascia/base/suggest.h>

namespace fascia {
namespace {

// Calls of the script cost more than instructions: some factor a matrix.
constexpr int kCallInstructions = 200;

std::string shown(lua_State* L, int index) {
  switch (lua_type(L, index)) {
    case LUA_TNIL:
      return "nil";
    case LUA_TBOOLEAN:
      return lua_toboolean(L, index) ? "true" : "false";
    case LUA_TNUMBER:
      return shortNumber(lua_tonumber(L, index));
    case LUA_TSTRING: {
      std::string text = quotedName(lua_tostring(L, index));
      text.front() = text.back() = '"';
      return text;
    }
    default:
      return "…";
  }
}

// As it may stand in the script: grab("hook.tip", "eye", -1, …)
std::string callText(lua_State* L, const ScriptFunction& function) {
  constexpr int kMostArguments = 4;
  const int count = lua_gettop(L);
  std::string text = std::string(function.name) + "(";
  for (int i = 1; i <= count && i <= kMostArguments; ++i) text += (i > 1 ? ", " : "") + shown(L, i);
  return text + (count > kMostArguments ? ", …)" : ")");
}

int dispatch(lua_State* L) {
  const auto& function =
      *static_cast<const ScriptFunction*>(lua_touserdata(L, lua_upvalueindex(1)));
  ScriptHost::of(L).charge(L, kCallInstructions);
  return guarded(L, [&] {
    const std::string call = callText(L, function);
    try {
      ScriptCall arguments(L, function);
      arguments.checkCount();
      return function.run(arguments);
    } catch (const Error& error) {
      Issue issue = error.issues().front();
      issue.message = call + ": " + issue.message;
      throw Error(issue);
    }
  });
}

}  // namespace

void openScriptFunctions(lua_State* L) {
  openVectors(L);
  for (const ScriptSection& section : scriptSections()) {
    for (const ScriptFunction& function : section.functions) {
      lua_pushlightuserdata(L, const_cast<ScriptFunction*>(&function));
      lua_pushcclosure(L, dispatch, 1);
      lua_setglobal(L, std::string(function.name).c_str());
    }
  }
}

void refuseValue(lua_State* L, int index, const std::string& what, const std::string& expected) {
  const int type = lua_type(L, index);
  const bool plain = type == LUA_TNUMBER || type == LUA_TSTRING || type == LUA_TBOOLEAN;
  const std::string found = type == LUA_TNONE  ? "nothing"
                            : type == LUA_TNIL ? "nil"
                            : plain            ? shown(L, index)
                                               : "a " + std::string(luaL_typename(L, index));
  throw Error(what + ": found " + found + ", expected " + expected);
}

std::string ScriptCall::nameOf(int i) const {
  // The last one may stand for any number of them.
  const std::size_t last = function_.parameters.size() - 1;
  return std::string(function_.parameters[std::min(static_cast<std::size_t>(i) - 1, last)].name);
}

void ScriptCall::refuse(int i, const std::string& expected) const {
  refuseValue(L, i, nameOf(i), expected);
}

void ScriptCall::checkCount() const {
  const bool repeated = !function_.parameters.empty() && function_.parameters.back().repeated;
  const auto most = static_cast<int>(function_.parameters.size());
  if (!repeated && count() > most)
    throw Error("found " + std::to_string(count()) + " arguments, expected " +
                std::to_string(most) + " at most");
}

PuppetPointId ScriptCall::anyPoint(int i) const {
  if (lua_type(L, i) != LUA_TSTRING) refuse(i, "the name of a point");
  std::size_t length = 0;
  const char* name = lua_tolstring(L, i, &length);
  return puppet().find({name, length});
}

PuppetPointId ScriptCall::bodyPoint(int i) const {
  const PuppetPointId point = anyPoint(i);
  puppet().bodyPoint(point);
  return point;
}

Target ScriptCall::target(int i) const {
  const int type = lua_type(L, i);
  if (type == LUA_TSTRING) return anyPoint(i);
  if (type != LUA_TTABLE && type != LUA_TUSERDATA)
    refuse(i, "the name of a point or a place such as {x, y, z}");
  return vector(i);
}

Vec3 ScriptCall::vector(int i) const {
  return vectorAt(i, nameOf(i));
}

double ScriptCall::number(int i, const ScriptRange& range) const {
  return numberAt(i, nameOf(i), range);
}

double ScriptCall::numberAt(int index, const std::string& what, const ScriptRange& range) const {
  const double value = lua_tonumber(L, index);
  const bool sound = lua_type(L, index) == LUA_TNUMBER && value <= range.high &&
                     (range.lowExcluded ? value > range.low : value >= range.low);
  if (!sound)
    refuseValue(L, index, what,
                std::string("a number in ") + (range.lowExcluded ? "(" : "[") +
                    shortNumber(range.low) + ", " + shortNumber(range.high) + "]");
  return value;
}

Vec3 ScriptCall::vectorAt(int index, const std::string& what) const {
  Vec3 v = Vec3::Zero();
  index = lua_absindex(L, index);
  if (const Vec3* given = toVector(L, index)) {
    v = *given;
  } else {
    if (lua_type(L, index) != LUA_TTABLE) refuseValue(L, index, what, "{x, y} or {x, y, z}");
    const auto length = static_cast<int>(lua_rawlen(L, index));
    if (length != 2 && length != 3)
      throw Error(what + ": found a table of " + std::to_string(length) +
                  " numbers, expected {x, y} or {x, y, z}");
    for (int axis = 0; axis < length; ++axis) {
      lua_rawgeti(L, index, axis + 1);
      v[axis] = numberAt(-1, what + "[" + std::to_string(axis + 1) + "]", kAnySign);
      lua_pop(L, 1);
    }
  }
  if (!v.allFinite() || v.cwiseAbs().maxCoeff() > kAnySign.high)
    throw Error(what + ": found a number that is not in [-1e9, 1e9]");
  return v;
}

std::string ScriptCall::text(int i) const {
  if (lua_type(L, i) != LUA_TSTRING) refuse(i, "a text");
  std::size_t length = 0;
  const char* text = lua_tolstring(L, i, &length);
  return {text, length};
}

void ScriptCall::checkFunction(int i) const {
  if (lua_type(L, i) != LUA_TFUNCTION) refuse(i, "a function");
}

void ScriptCall::checkTies() const {
  const auto most = static_cast<std::size_t>(host.limits().ties);
  if (puppet().connectionCount() + puppet().pushCount() >= most)
    throw Error("found more than " + std::to_string(most) + " connections and pushes at one time");
}

int ScriptCall::waitFor(BehaviourPtr behaviour) {
  behaviour->check(puppet());
  host.current().behaviour = std::move(behaviour);
  return lua_yield(L, 0);
}

}  // namespace fascia
