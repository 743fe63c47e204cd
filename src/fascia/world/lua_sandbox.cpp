#include <fascia/world/lua_sandbox.h>

#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

#include <fascia/base/suggest.h>

namespace fascia {
namespace {

// Instructions between two looks at the count and the clock.
constexpr int kCheckInterval = 256;
// What may be allocated in one update, freed or not: copying is work that no instruction counts.
constexpr std::size_t kTraffic_bytes = 256u << 20;

const char kFailureTag = 0;  // its address is the value of errors whose text is in failure_

std::string megabytes(std::size_t bytes) {
  return shortNumber(static_cast<double>(bytes) / (1 << 20)) + " MB";
}

// The line of `text` if it starts with "chunk:line: ", which is cut off; otherwise 0.
int cutPosition(std::string& text, std::string_view chunk) {
  const std::string start = std::string(chunk.substr(1)) + ":";  // without its '='
  if (!text.starts_with(start)) return 0;
  const std::size_t end = text.find(": ", start.size());
  if (end == std::string::npos) return 0;
  const int line = std::atoi(text.c_str() + start.size());
  text.erase(0, end + 2);
  return line;
}

// Where in the script a thread was when it failed: errors do not unwind threads.
int scriptLine(lua_State* thread) {
  lua_Debug frame;
  for (int level = 0; lua_getstack(thread, level, &frame) != 0; ++level) {
    lua_getinfo(thread, "Sl", &frame);
    if (frame.currentline > 0 && std::strcmp(frame.source, LuaSandbox::kScriptChunk) == 0)
      return frame.currentline;
  }
  return 0;
}

void offerFunctions(lua_State* L, NearestName& nearest, bool inside) {
  lua_pushnil(L);
  while (lua_next(L, -2) != 0) {
    if (lua_type(L, -2) == LUA_TSTRING) {
      if (lua_isfunction(L, -1)) nearest.offer(lua_tostring(L, -2));
      const std::string_view key = lua_tostring(L, -2);
      if (inside && lua_istable(L, -1) && (key == "math" || key == "string" || key == "table"))
        offerFunctions(L, nearest, false);
    }
    lua_pop(L, 1);
  }
}

// "attempt to call a nil value (global 'grabb')" says which name nobody knows.
Issue explainCall(lua_State* L, const std::string& text) {
  constexpr std::string_view kStart = "attempt to call a nil value (";
  if (!text.starts_with(kStart)) return {{}, text, {}};
  const std::size_t open = text.find('\''), close = text.rfind('\'');
  if (open == std::string::npos || close <= open) return {{}, text, {}};
  const std::string name = text.substr(open + 1, close - open - 1);
  NearestName nearest(name);
  lua_checkstack(L, 8);
  lua_pushglobaltable(L);
  offerFunctions(L, nearest, true);
  lua_pop(L, 1);
  return {{}, "there is no function " + quotedName(name), nearest.hint()};
}

}  // namespace

LuaSandbox::LuaSandbox(const ScriptLimits& limits) : limits_(limits) {
  beginUpdate();
  main_ = lua_newstate(&LuaSandbox::allocate, this);
  if (!main_) throw Error("script: found too small a limit of memory to start");
  lua_sethook(main_, &LuaSandbox::onCount, LUA_MASKCOUNT, kCheckInterval);
  lua_pushcfunction(main_, [](lua_State* L) {
    openSafeLibraries(L);
    return 0;
  });
  if (const int status = lua_pcall(main_, 0, 0, 0); status != LUA_OK) {
    const Issue issue = issueOf(main_, status);
    lua_close(main_);
    throw Error(issue);
  }
}

LuaSandbox::~LuaSandbox() {
  lua_close(main_);
}

LuaSandbox& LuaSandbox::of(lua_State* L) {
  void* self = nullptr;
  lua_getallocf(L, &self);
  return *static_cast<LuaSandbox*>(self);
}

void LuaSandbox::beginUpdate() {
  traffic_bytes_ = 0, instructions_ = 0, refusal_ = Refusal::none;
  deadline_ = std::chrono::steady_clock::now() +
              std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                  std::chrono::duration<double>(limits_.wall_clock_s));
}

LuaSandbox::Refusal LuaSandbox::refusalOf(std::size_t growth, std::size_t size) const {
  if (size > kLargestBlock_bytes) return Refusal::block;
  if (used_bytes_ + growth > limits_.memory_bytes) return Refusal::memory;
  if (traffic_bytes_ > kTraffic_bytes) return Refusal::traffic;
  return Refusal::none;
}

void* LuaSandbox::allocate(void* ud, void* block, std::size_t oldSize, std::size_t newSize) {
  LuaSandbox& self = *static_cast<LuaSandbox*>(ud);
  if (!block) oldSize = 0;  // Lua tells what it is for, then
  if (newSize == 0) {
    std::free(block);
    self.used_bytes_ -= oldSize;
    return nullptr;
  }
  if (newSize > oldSize) {
    const Refusal refusal = self.refusalOf(newSize - oldSize, newSize);
    if (refusal != Refusal::none) {
      self.refusal_ = refusal;
      return nullptr;
    }
    self.traffic_bytes_ += newSize;
  }
  void* moved = std::realloc(block, newSize);
  if (!moved) return newSize > oldSize ? nullptr : block;  // Lua shrinks without asking
  self.used_bytes_ += newSize - oldSize;
  return moved;
}

void LuaSandbox::onCount(lua_State* L, lua_Debug*) {
  of(L).charge(L, kCheckInterval);
}

void LuaSandbox::charge(lua_State* L, std::int64_t instructions) {
  instructions_ += instructions;
  total_ += instructions;
  if (total_ > limits_.instructions)
    fail(L, "ran for more than " + std::to_string(limits_.instructions) + " instructions in all",
         "wait for longer between looks at what happens");
  if (instructions_ > limits_.instructions_per_update)
    fail(L,
         "ran on for more than " + std::to_string(limits_.instructions_per_update) +
             " instructions without waiting",
         "a loop that goes on over time needs a wait");
  if (std::chrono::steady_clock::now() > deadline_)
    fail(L, "ran on for more than " + shortNumber(limits_.wall_clock_s) + " s without waiting",
         "a loop that goes on over time needs a wait");
}

void LuaSandbox::fail(lua_State* L, std::string message, std::string hint) {
  failure_ = {{}, std::move(message), std::move(hint)};
  lua_pushlightuserdata(L, const_cast<char*>(&kFailureTag));
  lua_error(L);
  std::abort();  // lua_error does not return, which its declaration does not say
}

Issue LuaSandbox::memoryIssue() const {
  switch (refusal_) {
    case Refusal::block:
      return {{},
              "found a string, a table or a recursion that needs more than " +
                  megabytes(kLargestBlock_bytes) + " in one piece",
              {}};
    case Refusal::traffic:
      return {{}, "used more than " + megabytes(kTraffic_bytes) + " of memory without waiting", {}};
    default:
      return {{}, "needs more than " + megabytes(limits_.memory_bytes) + " of memory", {}};
  }
}

Issue LuaSandbox::textIssue(lua_State* thread) const {
  std::string text = lua_type(thread, -1) == LUA_TSTRING
                         ? std::string(lua_tostring(thread, -1))
                         : "error of type " + std::string(luaL_typename(thread, -1));
  constexpr std::size_t kLongest = 1000;
  if (text.size() > kLongest) text.resize(kLongest), text += "…";
  const int line = cutPosition(text, kScriptChunk);
  cutPosition(text, kLibraryChunk);
  Issue issue = explainCall(thread, text);
  issue.where.line = line;
  return issue;
}

Issue LuaSandbox::issueOf(lua_State* thread, int status) const {
  const bool tagged = lua_touserdata(thread, -1) == &kFailureTag;
  Issue issue = status == LUA_ERRMEM ? memoryIssue() : tagged ? failure_ : textIssue(thread);
  if (issue.where.line == 0) issue.where.line = scriptLine(thread);
  return issue;
}

}  // namespace fascia
