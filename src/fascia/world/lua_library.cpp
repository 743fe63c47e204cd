#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include <fascia/base/suggest.h>
#include <fascia/world/lua_sandbox.h>

// Of Lua's libraries, what neither reaches out of the sandbox, nor depends on addresses, clocks or
// hash seeds, nor runs long in C, where no hook can stop it. Left out for that: io, os, package,
// debug, coroutine, utf8; load and its like; pcall, which would catch what is to end a script;
// metatables; patterns, which may take exponential time; table.move, string.pack and string.dump.
// Written anew: string.rep (for ever, with empty strings), table.insert and table.remove (the same,
// with a table whose few entries are so placed that its length is 2^62), pairs (its order changes
// from run to run), table.sort (so do its pivots), tostring and string.format (addresses).

namespace fascia {
namespace {

constexpr const char* kBase[] = {"assert", "error",  "ipairs",   "rawequal",
                                 "rawlen", "select", "tonumber", "type"};
constexpr const char* kMath[] = {
    "abs",  "acos", "asin", "atan", "ceil",       "cos",        "deg", "exp",  "floor",
    "fmod", "huge", "log",  "max",  "maxinteger", "mininteger", "min", "modf", "pi",
    "rad",  "sin",  "sqrt", "tan",  "type",       "tointeger",  "ult"};
constexpr const char* kString[] = {"byte",  "char",    "format", "len",
                                   "lower", "reverse", "sub",    "upper"};
constexpr const char* kTable[] = {"concat", "pack", "unpack"};

// In Lua, so that instructions count and functions given may be any. The sort is a stable merge.
constexpr const char* kTableFunctions = R"lua(
local type, error, select = type, error, select

local function check(list, name)
  if type(list) ~= "table" then
    error("bad argument #1 to '" .. name .. "' (table expected)", 3)
  end
  return #list
end

local function checkPosition(position, last, name)
  if type(position) ~= "number" or position < 1 or position > last or position % 1 ~= 0 then
    error("bad argument #2 to '" .. name .. "' (position out of bounds)", 3)
  end
end

function table.insert(list, ...)
  local count = check(list, "insert") + 1
  if select("#", ...) == 1 then list[count] = (...) return end
  local position, value = ...
  checkPosition(position, count, "insert")
  for i = count, position + 1, -1 do list[i] = list[i - 1] end
  list[position] = value
end

function table.remove(list, position)
  local count = check(list, "remove")
  if count == 0 and position == nil then return nil end
  position = position or count
  checkPosition(position, count + 1, "remove")
  local value = list[position]
  for i = position, count do list[i] = list[i + 1] end
  return value
end

function table.sort(list, less)
  less = less or function(a, b) return a < b end
  local count, from, to, width = check(list, "sort"), list, {}, 1
  while width < count do
    for first = 1, count, 2 * width do
      local middle, last = first + width, first + 2 * width
      if middle > count + 1 then middle = count + 1 end
      if last > count + 1 then last = count + 1 end
      local a, b = first, middle
      for i = first, last - 1 do
        if a < middle and (b >= last or not less(from[b], from[a])) then
          to[i] = from[a] a = a + 1
        else
          to[i] = from[b] b = b + 1
        end
      end
    end
    from, to, width = to, (from == list) and {} or from, 2 * width
  end
  if from ~= list then for i = 1, count do list[i] = from[i] end end
end
)lua";

int toString(lua_State* L) {
  luaL_checkany(L, 1);
  pushText(L, 1);
  return 1;
}

// string.format; the original is an upvalue.
int format(lua_State* L) {
  const char* pattern = luaL_checkstring(L, 1);
  for (const char* c = pattern; (c = std::strchr(c, '%')) != nullptr; ++c) {
    if (*++c == '%') continue;
    c += std::strspn(c, "-+ #0123456789.");
    if (*c == 'p') return luaL_error(L, "bad argument #1 to 'format' ('%%p' is not supported)");
    if (*c == '\0') break;
  }
  const int count = lua_gettop(L);
  for (int i = 2; i <= count; ++i) {
    if (lua_type(L, i) < LUA_TTABLE) continue;  // numbers and strings stay what they are
    pushText(L, i);
    lua_replace(L, i);
  }
  lua_pushvalue(L, lua_upvalueindex(1));
  lua_insert(L, 1);
  lua_call(L, count, 1);
  return 1;
}

int repeat(lua_State* L) {
  std::size_t length = 0, gap = 0;
  const char* text = luaL_checklstring(L, 1, &length);
  const lua_Integer count = luaL_checkinteger(L, 2);
  const char* separator = luaL_optlstring(L, 3, "", &gap);
  if (count <= 0 || length + gap == 0) return lua_pushliteral(L, ""), 1;
  if (static_cast<std::size_t>(count) > LuaSandbox::kLargestBlock_bytes / (length + gap))
    return luaL_error(L, "resulting string too large");
  luaL_Buffer buffer;
  luaL_buffinit(L, &buffer);
  for (lua_Integer i = 0; i < count; ++i) {
    luaL_addlstring(&buffer, text, length);
    if (i + 1 < count) luaL_addlstring(&buffer, separator, gap);
  }
  luaL_pushresult(&buffer);
  return 1;
}

struct Key {
  int rank;  // numbers, strings, booleans
  lua_Number number;
  std::string_view text;
  lua_Integer position;
};

Key keyAt(lua_State* L, int index, lua_Integer position) {
  switch (lua_type(L, index)) {
    case LUA_TNUMBER:
      return {0, lua_tonumber(L, index), {}, position};
    case LUA_TSTRING: {
      std::size_t length = 0;
      const char* text = lua_tolstring(L, index, &length);
      return {1, 0, {text, length}, position};
    }
    case LUA_TBOOLEAN:
      return {2, lua_toboolean(L, index) ? 1.0 : 0.0, {}, position};
    default:
      throw Error("pairs: found a key that is a " + std::string(luaL_typename(L, index)) +
                  ", expected numbers, strings or booleans, which have an order");
  }
}

int nextPair(lua_State* L) {
  lua_Integer position = lua_tointeger(L, lua_upvalueindex(2));
  for (;;) {
    lua_settop(L, 0);
    if (lua_rawgeti(L, lua_upvalueindex(1), ++position) == LUA_TNIL) return 1;
    lua_pushvalue(L, -1);
    if (lua_rawget(L, lua_upvalueindex(3)) != LUA_TNIL) break;  // or it is gone since
  }
  lua_pushinteger(L, position);
  lua_replace(L, lua_upvalueindex(2));
  return 2;
}

// Visits the keys that there are at the start, in ascending order.
int sortedPairs(lua_State* L) {
  luaL_checktype(L, 1, LUA_TTABLE);
  lua_settop(L, 1);
  std::vector<Key> keys;
  lua_newtable(L);  // 2: keys as they come
  lua_pushnil(L);
  while (lua_next(L, 1) != 0) {
    lua_pop(L, 1);
    const auto position = static_cast<lua_Integer>(keys.size() + 1);
    keys.push_back(keyAt(L, -1, position));
    lua_pushvalue(L, -1);
    lua_rawseti(L, 2, position);
  }
  LuaSandbox::of(L).charge(L, static_cast<std::int64_t>(4 * keys.size()));
  std::ranges::sort(keys, [](const Key& a, const Key& b) {
    return std::tie(a.rank, a.number, a.text) < std::tie(b.rank, b.number, b.text);
  });
  lua_createtable(L, static_cast<int>(keys.size()), 0);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    lua_rawgeti(L, 2, keys[i].position);
    lua_rawseti(L, 3, static_cast<lua_Integer>(i + 1));
  }
  lua_pushinteger(L, 0);
  lua_pushvalue(L, 1);
  lua_pushcclosure(L, nextPair, 3);
  return 1;
}

int safePairs(lua_State* L) {
  return guarded(L, [&] { return sortedPairs(L); });
}

// Moves the named fields of the table on top into a new one, which replaces it.
template <std::size_t Count>
void keepOnly(lua_State* L, const char* const (&names)[Count]) {
  lua_newtable(L);
  for (const char* name : names) {
    lua_getfield(L, -2, name);
    lua_setfield(L, -2, name);
  }
  lua_remove(L, -2);
}

void setFunction(lua_State* L, const char* name, lua_CFunction function) {
  lua_pushcfunction(L, function);
  lua_setfield(L, -2, name);
}

// Strings have methods: their metatable's __index is the library.
void openString(lua_State* L) {
  luaL_requiref(L, LUA_STRLIBNAME, luaopen_string, 0);
  keepOnly(L, kString);
  lua_getfield(L, -1, "format");
  lua_pushcclosure(L, format, 1);
  lua_setfield(L, -2, "format");
  setFunction(L, "rep", repeat);
  lua_pushliteral(L, "");
  lua_getmetatable(L, -1);
  lua_pushvalue(L, -3);
  lua_setfield(L, -2, "__index");
  lua_pop(L, 2);
}

}  // namespace

void pushText(lua_State* L, int index) {
  const int type = lua_type(L, index);
  const bool plain = type == LUA_TNIL || type == LUA_TBOOLEAN || type == LUA_TNUMBER ||
                     type == LUA_TSTRING || luaL_getmetafield(L, index, "__tostring") != LUA_TNIL;
  if (!plain) return void(lua_pushstring(L, lua_typename(L, type)));
  if (type == LUA_TUSERDATA) lua_pop(L, 1);
  luaL_tolstring(L, index, nullptr);
}

void openSafeLibraries(lua_State* L) {
  luaL_requiref(L, LUA_GNAME, luaopen_base, 0);
  keepOnly(L, kBase);
  setFunction(L, "tostring", toString);
  setFunction(L, "pairs", safePairs);
  luaL_requiref(L, LUA_MATHLIBNAME, luaopen_math, 0);
  keepOnly(L, kMath);
  lua_setfield(L, -2, "math");
  luaL_requiref(L, LUA_TABLIBNAME, luaopen_table, 0);
  keepOnly(L, kTable);
  lua_setfield(L, -2, "table");
  openString(L);
  lua_setfield(L, -2, "string");
  lua_rawseti(L, LUA_REGISTRYINDEX, LUA_RIDX_GLOBALS);
  lua_pushnil(L);
  lua_setfield(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE);
  if (luaL_loadbufferx(L, kTableFunctions, std::strlen(kTableFunctions), LuaSandbox::kLibraryChunk,
                       "t") != LUA_OK)
    lua_error(L);
  lua_call(L, 0, 0);
}

}  // namespace fascia
