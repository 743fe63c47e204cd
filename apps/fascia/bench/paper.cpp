#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>
#include <fascia/io/documents/character_file.h>

#include "bench/benches.h"
#include "example_files.h"
#include "simulation_options.h"

namespace fascia {
namespace {

constexpr const char* kPaperFooter =
    R"(The three characters of Turner & Gobbetti (1998), Table 1, with 1024 skin points each, on one
thread. "× real time" is simulated seconds per second of computing. A speed counts only beside what came
out: the longest edge over its rest length, how deep the skin was in the flesh, points that had to be put
back. Methods that would let the skin swing up at any step that is allowed say so.

Examples:
  fascia bench paper
  fascia bench paper --characters penguin --integrators verlet,auto --seconds 1)";

constexpr int kColumns = 32, kRows = 32;  // 1024 points, as in the paper

// What the paper measured: how many times slower than real time, and for leapfrog-Verlet the share
// of time in forces and in constraints.
struct PaperRow {
  const char* character;
  double euler, verlet, rk2;
  double forces_percent, constraints_percent;
};
constexpr std::array<PaperRow, 3> kTable1 = {{{"penguin", 20.7, 8.1, 15.1, 58.9, 17.4},
                                              {"wombat", 80.0, 28.5, 29.9, 15.5, 77.5},
                                              {"torso", 58.1, 24.5, 28.0, 16.0, 77.2}}};

// 0 where the paper has no figure. Our default is compared with its best, leapfrog-Verlet.
double paperSlowdown(const PaperRow& row, const std::string& integrator) {
  if (integrator == "euler") return row.euler;
  if (integrator == "rk2") return row.rk2;
  return row.verlet;
}

struct PaperOptions {
  std::string folder;
  std::vector<std::string> characters = {"penguin", "wombat", "torso"};
  std::vector<std::string> integrators = {"euler", "verlet", "rk2", "auto"};
  double seconds = 2;
};

struct PaperResult {
  double ratio = 0;  // × real time
  double paper_ratio = 0;
  double step_min_s = 0, step_max_s = 0;
  double forces = 0, constraints = 0;  // shares of the time
  double stretch = 0, penetration_m = 0;
  std::uint64_t repaired = 0;
};

PaperResult measure(const Character& character, const PaperRow& row, const std::string& integrator,
                    double seconds, const Console& console) {
  RecordOptions options;
  options.duration_s = seconds;
  const Recording recording = simulate(character, chooseMotion(character, {}), options, console);
  const SkinStats& stats = recording.stats;
  const double spent_s = stats.forces_s + stats.constraints_s + stats.other_s;
  PaperResult result;
  if (recording.wall_s > 0) result.ratio = recording.simulated_s / recording.wall_s;
  result.paper_ratio = 1 / paperSlowdown(row, integrator);
  result.step_min_s = stats.step_min_s;
  result.step_max_s = stats.step_max_s;
  result.stretch = stats.max_edge_stretch;
  result.penetration_m = stats.max_penetration_m;
  result.repaired = stats.repaired_points;
  if (spent_s > 0) result.forces = stats.forces_s / spent_s;
  if (spent_s > 0) result.constraints = stats.constraints_s / spent_s;
  return result;
}

Json toJson(const PaperRow& row, const std::string& integrator, const PaperResult& result) {
  return Json::Object{{"character", row.character},
                      {"integrator", integrator},
                      {"realtime_ratio", result.ratio},
                      {"paper_realtime_ratio", result.paper_ratio},
                      {"speedup", result.ratio / result.paper_ratio},
                      {"step_min_s", result.step_min_s},
                      {"step_max_s", result.step_max_s},
                      {"share_forces", result.forces},
                      {"share_constraints", result.constraints},
                      {"max_edge_stretch", result.stretch},
                      {"max_penetration_m", result.penetration_m},
                      {"repaired_points", static_cast<double>(result.repaired)}};
}

std::string toLine(const PaperRow& row, const std::string& integrator, const PaperResult& result) {
  return fmt::format(
      "{:9} {:8} {:8.3f} {:9.1f} {:8.0f} × {:7.2f}–{:<6.2f} {:5.1f} {:6.1f} {:8.2f} "
      "{:7.3f} {:7}",
      row.character, integrator, result.paper_ratio, result.ratio,
      result.ratio / result.paper_ratio, 1e3 * result.step_min_s, 1e3 * result.step_max_s,
      100 * result.forces, 100 * result.constraints, result.stretch, 1e3 * result.penetration_m,
      result.repaired);
}

void runPaper(const PaperOptions& options, const Console& console) {
  const ThreadLimit oneThread(1);
  const std::string folder = options.folder.empty() ? findExamples() : options.folder;
  console.say(
      "                       × real time                 step            % of time     "
      "longest   deepest  put");
  console.say(
      "character solver      paper      ours    ratio       (ms)       forces constr.  edge (×)  "
      "(mm)    back");
  Json::List results;
  for (const PaperRow& row : kTable1) {
    const auto& wanted = options.characters;
    if (std::find(wanted.begin(), wanted.end(), row.character) == wanted.end()) continue;
    for (const std::string& integrator : options.integrators) {
      try {
        const Character character = loadCharacter(
            folder + "/" + row.character + ".fascia.json",
            {.columns = kColumns, .rows = kRows, .integrator = integrator, .step_s = 0});
        const PaperResult result = measure(character, row, integrator, options.seconds, console);
        console.say(toLine(row, integrator, result));
        results.push_back(toJson(row, integrator, result));
      } catch (const Error& error) {
        if (error.issues().front().where.pointer != "/simulation/integrator") throw;
        console.say(
            fmt::format("{:9} {:8} {}", row.character, integrator, error.issues().front().message));
        results.push_back(Json::Object{{"character", row.character},
                                       {"integrator", integrator},
                                       {"refused", error.issues().front().message}});
      }
    }
    console.say(fmt::format("{:9} {:8} {:>55.1f} {:6.1f}", row.character, "(paper)",
                            row.forces_percent, row.constraints_percent));
  }
  console.answer(Json::Object{{"ok", true}, {"points", kColumns * kRows}, {"results", results}});
}

}  // namespace

void addPaperBench(CLI::App& group, Console& console) {
  CLI::App& command = *group.add_subcommand("paper", "The paper's Table 1 beside ours");
  const auto options = std::make_shared<PaperOptions>();
  command.add_option("--examples", options->folder, "Folder of the three character files")
      ->type_name("FOLDER");
  command.add_option("--characters", options->characters, "Which of penguin, wombat, torso")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST")
      ->check(CLI::IsMember({"penguin", "wombat", "torso"}).description(""));
  command.add_option("--integrators", options->integrators, "Which of euler, verlet, rk2, auto")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST")
      ->check(CLI::IsMember({"euler", "verlet", "rk2", "auto"}).description(""));
  command.add_option("--seconds", options->seconds, "Simulated seconds each (default: 2)")
      ->type_name("SECONDS")
      ->check(numberIn(0.1, 3600));
  console.addFlags(command);
  command.footer(kPaperFooter);
  command.callback([options, &console] { runPaper(*options, console); });
}

}  // namespace fascia
