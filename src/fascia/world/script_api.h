#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fascia {

class ScriptCall;

struct ScriptParameter {
  std::string_view name, type, help;
  bool optional = false;
  bool repeated = false;  // any number of these
};

inline constexpr ScriptParameter kPointParameter{"point", "string",
                                                 "a point of a body, by its name"};

// What scripts can call. One description of each function makes the names in messages, the
// completion in editors (schema/fascia-api.lua) and the page for readers (docs/scripting.md).
struct ScriptFunction {
  std::string_view name;
  std::vector<ScriptParameter> parameters;
  std::string_view resultType, result;  // empty: none
  std::string_view help;
  int (*run)(ScriptCall& call);  // as a lua_CFunction: how many results it has pushed
};

struct ScriptSection {
  std::string_view title;
  std::span<const ScriptFunction> functions;
};

std::span<const ScriptSection> scriptSections();

// One for each file of functions.
std::span<const ScriptFunction> behaviourFunctions();  // take time
std::span<const ScriptFunction> controlFunctions();    // act at once
std::span<const ScriptFunction> taskFunctions();
std::span<const ScriptFunction> queryFunctions();

// Annotations for the Lua language server (LuaLS), and tables of Markdown.
std::string scriptAnnotations();
std::string scriptReference();

}  // namespace fascia
