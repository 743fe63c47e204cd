#pragma once

#include <optional>
#include <string>

#include <lua.hpp>

#include <fascia/world/script_api.h>
#include <fascia/world/script_host.h>

namespace fascia {

// Numbers that an argument may be.
struct ScriptRange {
  double low, high;
  bool lowExcluded = false;
};
inline constexpr ScriptRange kDuration_s{0, 1e6, true}, kAnySign{-1e9, 1e9},
    kPositive{0, 1e9, true}, kNotNegative{0, 1e9};

// One call of a function by a script: its arguments, by number from 1. What is wrong with them is
// an Error; the caller adds which call it was.
class ScriptCall {
 public:
  ScriptCall(lua_State* thread, const ScriptFunction& function)
      : L(thread), host(ScriptHost::of(thread)), function_(function) {}

  lua_State* const L;
  ScriptHost& host;
  Puppet& puppet() const { return host.puppet(); }

  int count() const { return lua_gettop(L); }
  bool has(int i) const { return !lua_isnoneornil(L, i); }
  void checkCount() const;

  PuppetPointId anyPoint(int i) const;   // by its name
  PuppetPointId bodyPoint(int i) const;  // that can be controlled
  Target target(int i) const;            // a name or a place
  Vec3 vector(int i) const;
  double number(int i, const ScriptRange& range) const;
  std::string text(int i) const;
  void checkFunction(int i) const;
  void checkTies() const;  // that there may be one more

  // The task waits for the behaviour; the call then returns if it has succeeded.
  int waitFor(BehaviourPtr behaviour);

  // Of the value at any place of the stack; `what` is its name in messages.
  Vec3 vectorAt(int index, const std::string& what) const;
  double numberAt(int index, const std::string& what, const ScriptRange& range) const;

 private:
  std::string nameOf(int i) const;
  [[noreturn]] void refuse(int i, const std::string& expected) const;

  const ScriptFunction& function_;
};

// "found a table, expected …"
[[noreturn]] void refuseValue(lua_State* L, int index, const std::string& what,
                              const std::string& expected);

// Vectors as values of Lua: immutable, with operators.
void openVectors(lua_State* L);
void pushVector(lua_State* L, const Vec3& v);
const Vec3* toVector(lua_State* L, int index);  // or none

// All that scripts can call. Raises Lua errors.
void openScriptFunctions(lua_State* L);

}  // namespace fascia
