#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include <fascia/deformable/puppet/puppet.h>

namespace fascia {

// What a script may use up. More than that ends it with an Error.
struct ScriptLimits {
  std::size_t memory_bytes = 16u << 20;            // in all
  std::int64_t instructions_per_update = 1000000;  // some ten milliseconds
  std::int64_t instructions = 2'000'000'000;       // of the whole run: some twenty seconds
  // Of one update. The instructions should stop a script first; this is for the case that single
  // ones take long, as it makes the outcome depend on the machine.
  double wall_clock_s = 5;
  int tasks = 1000;
  int ties = 1000;        // connections, and pushes
  int log_lines = 10000;  // later ones are left out
};

struct ScriptLogLine {
  double time_s;
  std::string text;
};

enum class ScriptOutcome { none, succeeded, failed };

// A Lua script that drives a puppet (Witkin & Welch 1990, §4.2): each behaviour is a call, on one
// line, that comes back when it is done. docs/scripting.md is for those who write them.
//
//     Script script(text, "hook.lua", seed);
//     while (…) { script.update(puppet, h);  puppet.update(h);  stepper.step(h, state); }
//
// Scripts are not trusted. They reach the puppet and nothing else, no file, clock or program, and
// cannot go on for ever. The same seed gives the same bits.
class Script {
 public:
  // `file` is for messages. Throws Error if the text is not Lua.
  Script(std::string text, std::string file, std::uint64_t seed, const ScriptLimits& limits = {});
  ~Script();
  Script(const Script&) = delete;
  Script& operator=(const Script&) = delete;

  // Before each step of the length h_s and before puppet.update(), always with one puppet. Throws
  // Error, with file and line, if the script made a mistake or used up too much: it is finished
  // then.
  void update(Puppet& puppet, double h_s);

  bool finished() const;  // all tasks are through, or succeed() or fail() was called
  ScriptOutcome outcome() const;
  const std::string& reason() const;  // of a failure
  std::span<const ScriptLogLine> log() const;

 private:
  std::unique_ptr<class ScriptHost> host_;
};

}  // namespace fascia
