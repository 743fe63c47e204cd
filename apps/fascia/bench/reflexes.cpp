#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>
#include <fascia/io/documents/scene_file.h>
#include <fascia/world/performance.h>

#include "bench/benches.h"
#include "bench/machine.h"
#include "console.h"
#include "example_files.h"
#include "input_kind.h"
#include "progress.h"
#include "simulation_options.h"

namespace fascia {
namespace {

constexpr const char* kReflexesFooter =
    R"(A script is a reflex if it succeeds from many starts (Witkin & Welch 1990, section 4.2). Runs scenes
with the seeds 1, 2, 3, … until their scripts call succeed() or fail(), or time is up.

Examples:
  fascia bench reflexes
  fascia bench reflexes examples/sky-hook.fascia.json --runs 200)";

struct ReflexOptions {
  std::vector<std::string> scenes;
  int runs = 1000;
};

// How one start went; without a reason it succeeded.
struct Run {
  std::optional<std::string> failure;
  double took_s = 0;  // simulated
};

Run perform(const Stage& stage, std::uint64_t seed) {
  Run run;
  const SceneSimulationDef& simulation = stage.def().simulation;
  try {
    Performance performance(stage, seed);
    const Script* script = performance.script();
    if (!script) throw Error("the scene has no script");
    while (!script->finished() && performance.time_s() < simulation.duration_s)
      performance.advance(1 / simulation.frame_rate_hz);
    run.took_s = performance.time_s();
    if (script->outcome() == ScriptOutcome::failed) run.failure = script->reason();
    if (script->outcome() == ScriptOutcome::none)
      run.failure = script->finished() ? "neither succeed() nor fail() was called" : "out of time";
  } catch (const Error& error) {
    run.failure = error.what();
  }
  return run;
}

std::vector<Run> performAll(const Stage& stage, int runs, const Console& console) {
  constexpr std::size_t kBatch = 32;  // between looks at the person's wish to stop
  std::vector<Run> out(static_cast<std::size_t>(runs));
  ProgressBar progress(console, stage.def().name);
  for (std::size_t first = 0; first < out.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, out.size() - first);
    parallelFor(count, [&](std::size_t i) { out[first + i] = perform(stage, first + i + 1); });
    progress.update(static_cast<double>(first + count) / static_cast<double>(out.size()));
  }
  return out;
}

Json measure(const std::string& file, int runs, const Console& console) {
  std::optional<Stage> loaded;
  withInput(file, {.command = "bench reflexes", .scene = true},
            [&] { loaded.emplace(loadStage(file)); });
  const Stage& stage = *loaded;
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<Run> all = performAll(stage, runs, console);
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  double simulated_s = 0;
  Json::List failures;
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < all.size(); ++i) {
    simulated_s += all[i].took_s;
    if (!all[i].failure) continue;
    failures.push_back(
        Json::Object{{"seed", static_cast<int>(i + 1)}, {"reason", *all[i].failure}});
    lines.push_back(fmt::format("  --seed {}: {}", i + 1, *all[i].failure));
  }
  const auto failed = static_cast<int>(failures.size());
  const double rate = 100.0 * (runs - failed) / runs;
  console.say(fmt::format("{}: {} of {} starts succeed, {:.1f} %; {:.0f} × real time",
                          stage.def().name, runs - failed, runs, rate, simulated_s / wall_s));
  for (const std::string& line : lines) console.say(line);
  return Json::Object{{"scene", stage.def().name},      {"runs", runs},
                      {"succeeded", runs - failed},     {"rate_percent", rate},
                      {"simulated_s", simulated_s},     {"wall_s", wall_s},
                      {"failures", std::move(failures)}};
}

void runReflexes(const ReflexOptions& options, const Console& console) {
  std::vector<std::string> scenes = options.scenes;
  if (scenes.empty())
    for (const char* name : {"sky-hook", "hinge-horned-monster"})
      scenes.push_back(findExamples() + "/" + name + ".fascia.json");
  console.say(machineLine());
  Json::List results;
  for (const std::string& scene : scenes) results.push_back(measure(scene, options.runs, console));
  console.answer(
      Json::Object{{"ok", true}, {"machine", machineInfo()}, {"results", std::move(results)}});
}

}  // namespace

void addReflexesBench(CLI::App& group, Console& console) {
  CLI::App& command =
      *group.add_subcommand("reflexes", "From how many random starts scripts succeed");
  const auto options = std::make_shared<ReflexOptions>();
  command
      .add_option("SCENE", options->scenes,
                  "Scene files (default: the sky hook and the hinge-horned monster)")
      ->transform(exampleFiles())
      ->type_name("");
  command.add_option("--runs", options->runs, "Starts of each (default: 1000)")
      ->type_name("N")
      ->check(numberIn(1, 1e6));
  console.addFlags(command);
  command.footer(kReflexesFooter);
  command.callback([options, &console] { runReflexes(*options, console); });
}

}  // namespace fascia
