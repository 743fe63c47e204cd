#pragma once

#include <fascia/base/error.h>
#include <fascia/world/script.h>

#include "deformable/puppets.h"

namespace fascia::test {

// A script with a stage to play on, two floating bars in the plane unless told otherwise.
struct Play {
  explicit Play(const std::string& text, std::uint64_t seed = 1, const ScriptLimits& limits = {},
                int dimension = 2)
      : stage(dimension), script(text, "play.lua", seed, limits) {}

  void step(double h_s = PuppetStage::kStep_s) {
    script.update(*stage.puppet, h_s);
    stage.step(h_s);
  }
  // Until the script is through, or `t_s`.
  void run(double t_s = 5, double h_s = PuppetStage::kStep_s) {
    while (!script.finished() && stage.state.t_s < t_s - 1e-9) step(h_s);
  }
  // All lines of the log, with ';' between them.
  std::string log() const {
    std::string all;
    for (const ScriptLogLine& line : script.log()) all += (all.empty() ? "" : ";") + line.text;
    return all;
  }

  PuppetStage stage;
  Script script;
};

// The log of a script that ran to its end.
inline std::string logOf(const std::string& text, std::uint64_t seed = 1) {
  Play play(text, seed);
  play.run();
  return play.log();
}

// What a script is told, when it is read or while it runs; "" if nothing.
inline Issue issueOf(const std::string& text, const ScriptLimits& limits = {}) {
  try {
    Play play(text, 1, limits);
    play.run();
  } catch (const Error& error) {
    return error.issues().front();
  }
  return {};
}

}  // namespace fascia::test
