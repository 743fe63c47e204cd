#include "simulation_options.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <fascia/base/suggest.h>
#include <fascia/io/documents/character_file.h>

#include "input_kind.h"
#include "progress.h"
#include "report_map.h"

namespace fascia {
namespace {

std::vector<std::string> integratorNames() {
  const std::vector<std::string_view> names = skinIntegrators();
  return {names.begin(), names.end()};
}

std::string gridProblem(const std::string& text) {
  return sizeProblem(text, static_cast<int>(kGridSide.range.min),
                     static_cast<int>(kGridSide.range.max));
}

}  // namespace

void SimulationOptions::addMotionTo(CLI::App& command) {
  command
      .add_option(
          "--motion", motion,
          "A character's motion (default: the first); a .bvh or .glb file is put onto the rig")
      ->type_name("NAME");
}

void SimulationOptions::addTo(CLI::App& command) {
  command
      .add_option("--joint-map", joint_map,
                  "Which of that file's joints drive which of the rig's (default: guessed)")
      ->type_name("FILE");
  command
      .add_option("--duration", duration_s,
                  "How long to simulate (default: the motion's or scene's)")
      ->type_name("SECONDS")
      ->check(numberIn(1e-3, 86400));
  command.add_option("--grid", grid, "Skin points around x along, such as 64x16")
      ->type_name("MxN")
      ->check(gridProblem);
  command
      .add_option(
          "--integrator", integrator,
          fmt::format("How the skin steps through time: {}", fmt::join(integratorNames(), ", ")))
      ->type_name("NAME")
      ->check(CLI::IsMember(integratorNames()).description(""));
  command.add_option("--step", step_s, "Time step; 0 = chosen (default: as in the file)")
      ->type_name("SECONDS")
      ->check(numberIn(0, kLongestFrame_s));
  command.add_option("--seed", seed, "Of a scene: another start, within what its file allows")
      ->type_name("N")
      ->check(numberIn(0, 1e15));
  command.add_option("--threads", threads, "Threads to use; 0 = all. The result is the same")
      ->type_name("N")
      ->check(numberIn(0, 1024));
}

CLI::Validator numberIn(double low, double high) {
  return CLI::Validator(
      [low, high](const std::string& text) -> std::string {
        double number = 0;
        // Not a number is in no range, whichever way it is compared.
        if (CLI::detail::lexical_cast(text, number) && number >= low && number <= high) return {};
        return fmt::format("found {}, expected a number in [{:g}, {:g}]", quotedName(text), low,
                           high);
      },
      "");
}

BuildOptions SimulationOptions::buildOptions() const {
  const Size size = grid.empty() ? Size{} : parseSize(grid);
  return {.columns = size.width, .rows = size.height, .integrator = integrator, .step_s = step_s};
}

RecordOptions SimulationOptions::recordOptions() const {
  RecordOptions options;
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

Character prepareCharacter(const std::string& path, SimulationOptions& options,
                           const Console& console) {
  return prepareCharacter(readCharacterFile(path), options, console);
}

Character prepareCharacter(CharacterFile file, SimulationOptions& options, const Console& console) {
  if (!options.joint_map.empty() && !isMotionFile(options.motion))
    throw Error("--joint-map belongs to a motion from a file, such as --motion walk.bvh");
  if (options.seed != 0) throw Error("--seed is for scenes; a character has nothing to scatter");
  if (isMotionFile(options.motion)) {
    if (!file.def.rig)
      throw Error("the motion '" + options.motion + "' needs a character with a rig");
    RiggedModel model = *file.def.rig->model;
    MotionFile motion = readMotionFile(options.motion, model, options.joint_map);
    model.motions.push_back(ontoRig(motion, model));
    reportMap(motion, model, console);
    options.motion = model.motions.back().name;
    file.def.rig->model = std::make_shared<const RiggedModel>(std::move(model));
  }
  Character character = buildCharacter(file, options.buildOptions());
  console.warn(character.warnings());
  return character;
}

int chooseMotion(const Character& character, const std::string& name) {
  const int motion = character.findMotion(name);
  if (motion >= 0 || name.empty()) return motion;
  refuseMotionFile(name);
  std::vector<std::string> known;
  for (std::size_t i = 0; i < character.motionCount(); ++i)
    known.push_back(character.motion(i).name);
  Issue issue;
  issue.message = fmt::format("no motion is named {}; there are: {}", quotedName(name),
                              known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", ")));
  issue.hint = didYouMean(name, known);
  throw Error(std::move(issue));
}

Recording simulate(const Character& character, int motion, RecordOptions options,
                   const Console& console, const std::string& what) {
  ProgressBar progress(console, what);
  options.progress = [&](double fraction) {
    progress.update(fraction);
    return true;
  };
  return record(character, character.source(motion), options);
}

}  // namespace fascia
