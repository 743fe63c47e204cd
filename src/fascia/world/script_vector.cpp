#include <new>

#include <fascia/base/suggest.h>
#include <fascia/world/script_call.h>

namespace fascia {
namespace {

constexpr const char* kType = "vec";

// Of a vec, or of a table of two or three numbers.
Vec3 operand(lua_State* L, int index) {
  if (const Vec3* v = toVector(L, index)) return *v;
  if (lua_type(L, index) != LUA_TTABLE)
    throw Error("vec: found a " + std::string(luaL_typename(L, index)) + ", expected a vec");
  Vec3 v = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const int type = lua_rawgeti(L, index, axis + 1);
    if (type != LUA_TNUMBER && !(axis == 2 && type == LUA_TNIL))
      throw Error("vec: found a table, expected {x, y} or {x, y, z}");
    v[axis] = lua_tonumber(L, -1);
    lua_pop(L, 1);
  }
  return v;
}

double factor(lua_State* L, int index) {
  if (lua_type(L, index) == LUA_TNUMBER) return lua_tonumber(L, index);
  throw Error("vec: found a " + std::string(luaL_typename(L, index)) +
              ", expected a number to multiply or divide by");
}

template <class Function>
int result(lua_State* L, Function&& compute) {
  return guarded(L, [&] { return pushVector(L, compute()), 1; });
}
template <class Function>
int scalarResult(lua_State* L, Function&& compute) {
  return guarded(L, [&] { return lua_pushnumber(L, compute()), 1; });
}

int add(lua_State* L) {
  return result(L, [&]() -> Vec3 { return operand(L, 1) + operand(L, 2); });
}
int subtract(lua_State* L) {
  return result(L, [&]() -> Vec3 { return operand(L, 1) - operand(L, 2); });
}
int multiply(lua_State* L) {
  return result(L, [&]() -> Vec3 {
    if (lua_type(L, 1) == LUA_TNUMBER) return lua_tonumber(L, 1) * operand(L, 2);
    return operand(L, 1) * factor(L, 2);
  });
}
int divide(lua_State* L) {
  return result(L, [&]() -> Vec3 { return operand(L, 1) / factor(L, 2); });
}
int negate(lua_State* L) {
  return result(L, [&]() -> Vec3 { return -operand(L, 1); });
}
int equal(lua_State* L) {
  const Vec3 *a = toVector(L, 1), *b = toVector(L, 2);
  lua_pushboolean(L, a && b && *a == *b ? 1 : 0);
  return 1;
}
int dot(lua_State* L) {
  return scalarResult(L, [&] { return operand(L, 1).dot(operand(L, 2)); });
}
int cross(lua_State* L) {
  return result(L, [&]() -> Vec3 { return operand(L, 1).cross(operand(L, 2)); });
}
int length(lua_State* L) {
  return scalarResult(L, [&] { return operand(L, 1).norm(); });
}
int normalized(lua_State* L) {
  return result(L, [&]() -> Vec3 {
    const Vec3 v = operand(L, 1);
    if (!(v.norm() > 0)) throw Error("vec: found one without length, which has no direction");
    return v / v.norm();
  });
}

int toText(lua_State* L) {
  return guarded(L, [&] {
    const Vec3 v = operand(L, 1);
    std::string text;
    for (const double number : v)
      text.append(text.empty() ? "(" : ", ").append(shortNumber(number));
    text += ")";
    return lua_pushstring(L, text.c_str()), 1;
  });
}

constexpr luaL_Reg kMethods[] = {
    {"dot", dot}, {"cross", cross}, {"length", length}, {"normalized", normalized}};
constexpr luaL_Reg kOperators[] = {{"__add", add},        {"__sub", subtract}, {"__mul", multiply},
                                   {"__div", divide},     {"__unm", negate},   {"__eq", equal},
                                   {"__tostring", toText}};

int field(lua_State* L) {
  return guarded(L, [&] {
    const Vec3 v = operand(L, 1);
    const std::string_view key = lua_type(L, 2) == LUA_TSTRING ? lua_tostring(L, 2) : "";
    constexpr std::string_view kAxes = "xyz";
    if (key.size() == 1 && kAxes.find(key) != std::string_view::npos)
      return lua_pushnumber(L, v[static_cast<int>(kAxes.find(key))]), 1;
    for (const luaL_Reg& method : kMethods)
      if (key == method.name) return lua_pushcfunction(L, method.func), 1;
    NearestName nearest(key);
    for (const luaL_Reg& method : kMethods) nearest.offer(method.name);
    Issue issue{
        {}, "a vec has no field " + quotedName(key) + ", it has x, y and z", nearest.hint()};
    throw Error(issue);
  });
}

int setField(lua_State* L) {
  return guarded(L, [&]() -> int {
    Issue issue{{}, "the numbers of a vec do not change", "make a new one: vec(x, y, z)"};
    throw Error(issue);
  });
}

}  // namespace

void openVectors(lua_State* L) {
  luaL_newmetatable(L, kType);
  for (const luaL_Reg& entry : kOperators) {
    lua_pushcfunction(L, entry.func);
    lua_setfield(L, -2, entry.name);
  }
  lua_pushcfunction(L, field);
  lua_setfield(L, -2, "__index");
  lua_pushcfunction(L, setField);
  lua_setfield(L, -2, "__newindex");
  lua_pop(L, 1);
}

void pushVector(lua_State* L, const Vec3& v) {
  static_assert(std::is_trivially_destructible_v<Vec3>);
  new (lua_newuserdatauv(L, sizeof(Vec3), 0)) Vec3(v);
  luaL_setmetatable(L, kType);
}

const Vec3* toVector(lua_State* L, int index) {
  return static_cast<const Vec3*>(luaL_testudata(L, index, kType));
}

}  // namespace fascia
