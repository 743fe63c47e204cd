#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fascia/base/random.h>
#include <fascia/world/lua_sandbox.h>
#include <fascia/world/script.h>

namespace fascia {

// A function of the script that goes on over time: a coroutine. While it waits, a behaviour works
// for it, or other tasks do, or it just waits for the next step.
struct ScriptTask {
  int id = 0;
  lua_State* thread = nullptr;
  int reference = LUA_NOREF;  // keeps the thread
  BehaviourPtr behaviour;
  std::vector<int> children;  // parallel()
  bool result = true;         // of what it waited for
  bool started = false;
  bool waitsForStep = false;
  bool finished = false;
};

// What runs a script: its tasks, in the order in which they were started.
class ScriptHost : public LuaSandbox {
 public:
  ScriptHost(std::string text, std::string file, std::uint64_t seed, const ScriptLimits& limits);

  static ScriptHost& of(lua_State* L) { return static_cast<ScriptHost&>(LuaSandbox::of(L)); }

  void update(Puppet& puppet, double h_s);

  // For the functions of scripts, during update().
  Puppet& puppet() { return *puppet_; }
  double step_s() const { return step_s_; }
  ScriptTask& current() { return *current_; }
  const ScriptLimits& limits() const { return limits_; }
  Random& random() { return random_; }
  // A task that calls the function at `index` of L. Throws Error if there are too many.
  int startTask(lua_State* L, int index);
  void cancelTask(int id);
  bool taskRuns(int id) const;
  void log(std::string text);
  static constexpr std::size_t kLongestLine = 1000;  // of the log; the rest is left out
  // Ends the script: raises a Lua error that no script can catch.
  [[noreturn]] void end(lua_State* L, ScriptOutcome outcome, std::string reason);

  bool finished() const { return finished_; }
  ScriptOutcome outcome() const { return outcome_; }
  const std::string& reason() const { return reason_; }
  std::span<const ScriptLogLine> logLines() const { return log_; }

 private:
  void load(const std::string& text);
  ScriptTask* findTask(int id) const;
  bool waits(ScriptTask& task);
  bool advance(ScriptTask& task);
  void resume(ScriptTask& task);
  void runTasks();
  void sweep();
  void finish();
  [[noreturn]] void raise(Issue issue);

  std::string file_;
  ScriptLimits limits_;
  Random random_;
  std::vector<std::unique_ptr<ScriptTask>> tasks_;
  int nextTask_ = 1;
  Puppet* puppet_ = nullptr;
  double step_s_ = 0;
  ScriptTask* current_ = nullptr;
  std::vector<ScriptLogLine> log_;
  ScriptOutcome outcome_ = ScriptOutcome::none;
  std::string reason_;
  bool finished_ = false;
};

}  // namespace fascia
