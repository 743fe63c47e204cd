#include <filesystem>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/io/documents/character_file.h>
#include <fascia/io/documents/scene_file.h>
#include <fascia/io/documents/stats_writer.h>
#include <fascia/render/camera.h>
#include <fascia/world/performance.h>

#include "commands.h"
#include "console.h"
#include "example_files.h"
#include "input_kind.h"
#include "lively_motion.h"
#include "shell_word.h"
#include "stage_run.h"

namespace fascia {
namespace {

constexpr const char* kCheckFooter =
    R"(Every fault is listed, a line each, with file, line and the place in the document. So is every setting
that has no effect in its file, as a warning: warnings do not fail the check.

Examples:
  fascia check examples/penguin.fascia.json
  fascia check examples/sky-hook.fascia.json
  fascia check --json examples/wombat.fascia.json examples/torso.fascia.json)";

// A film of it, or a picture of what stands still.
std::string renderCommand(const std::string& path, const std::string& motion, bool moves) {
  std::string name = std::filesystem::path(path).filename().string();
  name = name.substr(0, name.find('.')) + (moves ? ".mp4" : ".png");
  return "fascia render " + shellWord(path) + motionOption(motion) + " -o " + shellWord(name);
}

struct Checked {
  std::vector<Issue> warnings;
  std::size_t conflicts = 0;  // of constraints
  std::vector<Redundancy> redundancies;
  std::string next;  // the command that shows it
};

// Builds what the file holds; a scene is started too: its script is read then.
Checked checkFile(const std::string& path, const Console& console) {
  if (!isSceneFile(path)) {
    const Character character = loadCharacter(path);
    const std::string motion = livelyMotion(character);
    return {character.warnings(), 0, {}, renderCommand(path, motion, !motion.empty())};
  }
  const Stage stage = loadStage(path);
  if (!stage.def().view.camera.empty()) parseCamera(stage.def().view.camera);
  const Performance performance(stage);
  reportTroubles(stage, performance.troubles(), console);
  const std::span<const Redundancy> found = performance.redundancies();
  const std::size_t conflicts = reportRedundancies(found, console, path);
  return {stage.warnings(), conflicts, {found.begin(), found.end()}, renderCommand(path, {}, true)};
}

std::string verdict(std::size_t warnings) {
  return warnings == 0 ? "ok" : fmt::format("ok, {} warning{}", warnings, warnings > 1 ? "s" : "");
}

void check(const std::vector<std::string>& paths, const Console& console) {
  std::vector<Issue> issues;
  std::string next;
  std::vector<Redundancy> redundancies;
  for (const std::string& path : paths) {
    try {
      Checked checked;
      withInput(path, {.command = "check", .character = true, .scene = true},
                [&] { checked = checkFile(path, console); });
      console.warn(checked.warnings);
      console.say(path + ": " + verdict(checked.warnings.size() + checked.conflicts));
      redundancies.insert(redundancies.end(), checked.redundancies.begin(),
                          checked.redundancies.end());
      next = checked.next;
    } catch (const Error& error) {
      issues.insert(issues.end(), error.issues().begin(), error.issues().end());
    }
  }
  if (!issues.empty()) throw Error(std::move(issues));
  if (paths.size() == 1) console.say("next: " + next);
  std::vector<Issue> none;
  Json constraints = parseJson(redundanciesJson(redundancies), JsonLimits{}, none);
  console.answer(Json::Object{
      {"ok", true}, {"issues", Json::List{}}, {"constraints", std::move(constraints)}});
}

}  // namespace

void addCheck(CLI::App& program, Console& console) {
  CLI::App& command = *program.add_subcommand("check", "Find everything that is wrong with a file");
  const auto paths = std::make_shared<std::vector<std::string>>();
  command.add_option("FILE", *paths, "One or more *.fascia.json files: characters or scenes")
      ->required()
      ->transform(exampleFiles())
      ->type_name("");
  console.addFlags(command);
  command.footer(kCheckFooter);
  command.callback([paths, &console] { check(*paths, console); });
}

}  // namespace fascia
