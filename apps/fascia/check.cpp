#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/io/documents/character_file.h>
#include <fascia/io/documents/scene_file.h>
#include <fascia/render/camera.h>
#include <fascia/world/performance.h>

#include "commands.h"
#include "console.h"
#include "stage_run.h"

namespace fascia {
namespace {

constexpr const char* kCheckFooter =
    R"(Every fault is listed, a line each, with file, line and the place in the document.

Examples:
  fascia check examples/penguin.fascia.json
  fascia check examples/sky-hook.fascia.json
  fascia check --json mine.fascia.json yours.fascia.json)";

// Builds what the file holds; a scene is started too: its script is read then.
void checkFile(const std::string& path, const Console& console) {
  if (!isSceneFile(path)) {
    loadCharacter(path);
    return;
  }
  const Stage stage = loadStage(path);
  if (!stage.def().view.camera.empty()) parseCamera(stage.def().view.camera);
  const Performance performance(stage);
  reportTroubles(stage, performance.troubles(), console);
}

void check(const std::vector<std::string>& paths, const Console& console) {
  std::vector<Issue> issues;
  for (const std::string& path : paths) {
    try {
      checkFile(path, console);
      console.say(path + ": ok");
    } catch (const Error& error) {
      issues.insert(issues.end(), error.issues().begin(), error.issues().end());
    }
  }
  if (!issues.empty()) throw Error(std::move(issues));
  console.answer(Json::Object{{"ok", true}, {"issues", Json::List{}}});
}

}  // namespace

void addCheck(CLI::App& program, Console& console) {
  CLI::App& command = *program.add_subcommand("check", "Find everything that is wrong with a file");
  const auto paths = std::make_shared<std::vector<std::string>>();
  command.add_option("FILE", *paths, "One or more *.fascia.json files: characters or scenes")
      ->required()
      ->type_name("");
  console.addFlags(command);
  command.footer(kCheckFooter);
  command.callback([paths, &console] { check(*paths, console); });
}

}  // namespace fascia
