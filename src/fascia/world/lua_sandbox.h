#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include <lua.hpp>

#include <fascia/base/error.h>
#include <fascia/world/script.h>

namespace fascia {

// A Lua state that cannot reach out and cannot run away: memory, instructions and time are counted,
// and of the libraries there is only what stays within that count (lua_library.cpp). Lua is
// compiled as C++, so that its errors are exceptions and destructors run.
class LuaSandbox {
 public:
  explicit LuaSandbox(const ScriptLimits& limits);  // throws Error if the limits are too small
  ~LuaSandbox();
  LuaSandbox(const LuaSandbox&) = delete;
  LuaSandbox& operator=(const LuaSandbox&) = delete;

  static LuaSandbox& of(lua_State* L);
  lua_State* main() const { return main_; }

  // Starts to count anew.
  void beginUpdate();
  // Counts work of a C function like instructions; raises a Lua error if that was too much.
  void charge(lua_State* L, std::int64_t instructions);
  // Raises a Lua error of this message.
  [[noreturn]] void fail(lua_State* L, std::string message, std::string hint = {});

  // What is wrong with a thread that ended with the status, and where in the script.
  Issue issueOf(lua_State* thread, int status) const;

  // Chunk names: in messages of Lua, and to tell the script from the library.
  static constexpr const char* kScriptChunk = "=script";
  static constexpr const char* kLibraryChunk = "=library";
  // A table of more than 65536 numbers, a string of a megabyte, a recursion 10 000 deep. Operations
  // on what is in one block take no time that a count per instruction would have to know of.
  static constexpr std::size_t kLargestBlock_bytes = 1u << 20;

 private:
  enum class Refusal { none, memory, block, traffic };
  static void* allocate(void* self, void* block, std::size_t oldSize, std::size_t newSize);
  static void onCount(lua_State* L, lua_Debug*);
  Refusal refusalOf(std::size_t growth, std::size_t size) const;
  Issue memoryIssue() const;
  Issue textIssue(lua_State* thread) const;

  ScriptLimits limits_;
  lua_State* main_ = nullptr;
  std::size_t used_bytes_ = 0;     // at present
  std::size_t traffic_bytes_ = 0;  // allocated since beginUpdate()
  std::int64_t instructions_ = 0;  // since beginUpdate()
  std::int64_t total_ = 0;         // of all updates
  std::chrono::steady_clock::time_point deadline_;
  Refusal refusal_ = Refusal::none;
  Issue failure_;  // of the last fail()
};

// Opens what is safe of Lua's base, math, string and table libraries. Raises Lua errors.
void openSafeLibraries(lua_State* L);

// Pushes a value as a string without addresses in it. Raises Lua errors.
void pushText(lua_State* L, int index);

// Calls a C++ function of Lua so that a C++ exception in it becomes a Lua error.
template <class Function>
int guarded(lua_State* L, Function&& function) {
  std::string message, hint;
  try {
    return function();
  } catch (const Error& error) {
    message = error.issues().front().message, hint = error.issues().front().hint;
  } catch (const std::exception& error) {
    message = error.what();
  }
  LuaSandbox::of(L).fail(L, std::move(message), std::move(hint));
}

}  // namespace fascia
