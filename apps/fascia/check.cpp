#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/io/documents/character_file.h>
#include <fascia/io/documents/scene_file.h>
#include <fascia/render/camera.h>
#include <fascia/world/performance.h>

#include "commands.h"
#include "console.h"

namespace fascia {
namespace {

constexpr const char* kCheckFooter =
    R"(Every fault is listed, a line each, with file, line and the place in the document. So is every setting
that has no effect in its file, as a warning: warnings do not fail the check.

Examples:
  fascia check examples/penguin.fascia.json
  fascia check examples/sky-hook.fascia.json
  fascia check --json mine.fascia.json yours.fascia.json)";

// Builds what the file holds; a scene is started too: its script is read then. Returns what it is
// warned of.
std::vector<Issue> checkFile(const std::string& path) {
  if (!isSceneFile(path)) return loadCharacter(path).warnings();
  const Stage stage = loadStage(path);
  if (!stage.def().view.camera.empty()) parseCamera(stage.def().view.camera);
  const Performance performance(stage);
  return stage.warnings();
}

std::string verdict(std::size_t warnings) {
  return warnings == 0 ? "ok" : fmt::format("ok, {} warning{}", warnings, warnings > 1 ? "s" : "");
}

void check(const std::vector<std::string>& paths, const Console& console) {
  std::vector<Issue> issues;
  for (const std::string& path : paths) {
    try {
      const std::vector<Issue> warnings = checkFile(path);
      console.warn(warnings);
      console.say(path + ": " + verdict(warnings.size()));
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
