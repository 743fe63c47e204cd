#include <fascia/world/script_api.h>

// The two other forms of the description of what scripts can call.

namespace fascia {
namespace {

constexpr std::string_view kHeader = R"(---@meta
-- What Fascia's scripts can call: for completion and checks in editors (LuaLS). Generated from the
-- functions themselves; docs/scripting.md explains them.

---A vector: m, m/s or N. Its numbers do not change.
---@class vec
---@field x number
---@field y number
---@field z number
---@operator add(vec): vec
---@operator sub(vec): vec
---@operator mul(number): vec
---@operator div(number): vec
---@operator unm: vec
local vec_methods = {}
---@return number
function vec_methods:length() end
---@return vec
function vec_methods:normalized() end
---@param other vec
---@return number
function vec_methods:dot(other) end
---@param other vec
---@return vec
function vec_methods:cross(other) end

---A vec, {x, y} or {x, y, z}.
---@alias place vec|number[]

---The name of a point, or a place.
---@alias target string|place

---One place of a path, as {time, at, velocity, velocity_out} or with these names.
---@class key
---@field time? number seconds after the onset
---@field at? place m
---@field velocity? place m/s; by default that of the smooth path through all keys
---@field velocity_out? place after this key, if the velocity jumps there
---@field [integer] number|place

---@class follow_options
---@field preroll? number seconds to lead the point to the path; 0.25 by default
---@field onset? number time() at which the path starts; by default after the preroll

---What start() gives.
---@class task
)";

std::string signature(const ScriptFunction& function) {
  std::string text = std::string(function.name) + "(", closing;
  bool first = true;
  for (const ScriptParameter& parameter : function.parameters) {
    if (parameter.optional) text += "[", closing += "]";
    text += std::string(first ? "" : ", ") + std::string(parameter.name);
    if (parameter.repeated) text += ", …";
    first = false;
  }
  return text + closing + ")";
}

void annotate(const ScriptFunction& function, std::string& text) {
  text += "\n---" + std::string(function.help) + "\n";
  std::string names;
  for (const ScriptParameter& parameter : function.parameters) {
    const std::string name(parameter.repeated ? "..." : parameter.name);
    text.append("---@param ").append(name).append(parameter.optional ? "? " : " ");
    text.append(parameter.type).append(parameter.help.empty() ? "" : " ").append(parameter.help);
    text += "\n";
    names += (names.empty() ? "" : ", ") + name;
  }
  if (!function.resultType.empty())
    text += "---@return " + std::string(function.resultType) + " # " +
            std::string(function.result) + "\n";
  text += "function " + std::string(function.name) + "(" + names + ") end\n";
}

}  // namespace

std::string scriptAnnotations() {
  std::string text(kHeader);
  for (const ScriptSection& section : scriptSections())
    for (const ScriptFunction& function : section.functions) annotate(function, text);
  return text;
}

std::string scriptReference() {
  std::string text;
  for (const ScriptSection& section : scriptSections()) {
    text += (text.empty() ? "### " : "\n### ") + std::string(section.title) + "\n\n";
    text += "| call | what it does | gives |\n|---|---|---|\n";
    for (const ScriptFunction& function : section.functions) {
      text += "| `" + signature(function) + "` | " + std::string(function.help);
      for (const ScriptParameter& parameter : function.parameters)
        if (!parameter.help.empty())
          text += "<br>*" + std::string(parameter.name) + "*: " + std::string(parameter.help);
      text += " | " + std::string(function.result) + " |\n";
    }
  }
  return text;
}

}  // namespace fascia
