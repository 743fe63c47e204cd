#include "simulation_options.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include <CLI/CLI.hpp>

#include "interrupt.h"
#include "progress.h"

namespace fascia {
namespace {

constexpr int kMinGrid = 8, kMaxGrid = 4096;  // as in SkinDef

const std::vector<std::string>& integratorNames() {
  static const std::vector<std::string> names = {"auto", "euler", "implicit-euler", "verlet",
                                                 "rk2",  "rk4",   "rosenbrock4",    "xpbd"};
  return names;
}

}  // namespace

void SimulationOptions::addTo(CLI::App& command) {
  command.add_option("--motion", motion, "Motion to simulate, by name (default: the first)");
  command.add_option("--duration", duration_s, "Seconds to simulate (default: the motion's)")
      ->check(CLI::Range(1e-3, 86400.0));
  command.add_option("--grid", grid, "Skin points around x along, such as 64x16")
      ->check([](const std::string& text) { return sizeProblem(text, kMinGrid, kMaxGrid); });
  command.add_option("--integrator", integrator, "How the skin steps through time")
      ->check(CLI::IsMember(integratorNames()));
  command
      .add_option("--step", step_s, "Time step in seconds; 0 = chosen (default: as in the file)")
      ->check(CLI::Range(0.0, 1.0 / 12));
  command.add_option("--threads", threads, "Threads to use; 0 = all. The result is the same")
      ->check(CLI::Range(0, 1024));
}

BuildOptions SimulationOptions::buildOptions() const {
  const Size size = grid.empty() ? Size{} : parseSize(grid);
  return {.columns = size.width, .rows = size.height, .integrator = integrator, .step_s = step_s};
}

RecordOptions SimulationOptions::recordOptions(const Character& character) const {
  RecordOptions options;
  options.motion = chooseMotion(character, motion);
  options.frame_rate_hz = frame_rate_hz;
  options.duration_s = duration_s;
  return options;
}

Size parseSize(const std::string& text) {
  Size size;
  char x = 0, rest = 0;
  std::istringstream in(text);
  if (!(in >> size.width >> x >> size.height) || x != 'x' || in >> rest) return {};
  return size;
}

std::string sizeProblem(const std::string& text, int low, int high) {
  const Size size = parseSize(text);
  if (std::min(size.width, size.height) >= low && std::max(size.width, size.height) <= high)
    return {};
  return "found '" + text + "', expected WIDTHxHEIGHT, each in [" + std::to_string(low) + ", " +
         std::to_string(high) + "]";
}

int chooseMotion(const Character& character, const std::string& name) {
  const int motion = character.findMotion(name);
  if (motion >= 0 || name.empty()) return motion;
  std::string known;
  for (std::size_t i = 0; i < character.motionCount(); ++i)
    known += (i > 0 ? ", " : "") + character.motion(i).name;
  throw Error("no motion is named '" + name + "'; there are: " + known);
}

Recording simulate(const Character& character, RecordOptions options, const Console& console) {
  Progress progress(console, "simulating");
  options.progress = [&](double fraction) {
    if (!progress.update(fraction)) throw Interrupted{};
    return true;
  };
  return record(character, options);
}

}  // namespace fascia
