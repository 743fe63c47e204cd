#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>
#include <fascia/io/documents/character_file.h>

#include "bench/benches.h"
#include "bench/machine.h"
#include "example_files.h"
#include "input_kind.h"
#include "simulation_options.h"

namespace fascia {
namespace {

constexpr const char* kScalingFooter =
    R"(One character with 1024, 10 000 and 100 000 skin points, on 1 and 2 threads. "× real time" is
simulated seconds per second of computing.

Examples:
  fascia bench scaling
  fascia bench scaling examples/wombat.fascia.json --points 1000,10000 --threads 1)";

constexpr double kFrame_s = 1.0 / 60;
// Frames that are simulated, but not timed: caches and scratch memory warm up.
constexpr int kWarmFrames = 6;
// Penetration and stretch are looked at in every so many frames: measuring costs more than
// stepping.
constexpr int kMeasureEvery = 4;

struct ScalingOptions {
  std::string character;  // empty = the example penguin
  std::string motion;
  std::string integrator;
  std::vector<int> points = {1024, 10000, 100000};
  std::vector<int> threads = {1, 2};
  double seconds = 2;
};

struct ScalingResult {
  int columns = 0, rows = 0, threads = 0;
  double ratio = 0;  // × real time
  double frame_s = 0, steps_per_frame = 0;
  double nsPerPointStep = 0;
  SkinStats stats;
  double bytesPerPoint = 0;

  double points() const { return static_cast<double>(columns) * rows; }
  double share(double part_s) const {
    return part_s / std::max(1e-12, stats.forces_s + stats.constraints_s + stats.other_s);
  }
};

// As many columns as rows, like the examples.
BuildOptions gridOf(int points, const std::string& integrator) {
  const int rows = std::max(8, static_cast<int>(std::lround(std::sqrt(points))));
  return {
      .columns = std::max(8, (points + rows / 2) / rows), .rows = rows, .integrator = integrator};
}

ScalingResult measure(const std::string& file, const BuildOptions& build, int threads,
                      const ScalingOptions& options) {
  const ThreadLimit limit(threads);
  const std::size_t heapBefore = heapInUse_bytes();
  std::unique_ptr<const Character> character;
  withInput(file, {.command = "bench scaling", .character = true},
            [&] { character = std::make_unique<const Character>(loadCharacter(file, build)); });
  if (!character->skin()) throw Error("the character has no skin to measure");
  const int motion = chooseMotion(*character, options.motion);
  CharacterState state = initialState(*character, character->source(motion));

  ScalingResult result;
  result.columns = build.columns, result.rows = build.rows, result.threads = threads;
  const int frames = std::max(1, static_cast<int>(std::lround(options.seconds / kFrame_s)));
  double wall_s = 0;
  for (int f = 0; f < kWarmFrames + frames; ++f) {
    if (f == kWarmFrames) result.stats = {}, wall_s = 0;
    const auto begin = std::chrono::steady_clock::now();
    advance(*character, character->source(motion), kFrame_s, state, result.stats);
    wall_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (f % kMeasureEvery == 0)
      measureSkin(*character->skin(), {&state.flesh, state.skeleton.joint_world}, state.skin,
                  result.stats);
  }
  result.bytesPerPoint =
      static_cast<double>(heapInUse_bytes() - heapBefore) / std::max(1.0, result.points());
  result.ratio = frames * kFrame_s / wall_s;
  result.frame_s = wall_s / frames;
  result.steps_per_frame = static_cast<double>(result.stats.steps) / frames;
  result.nsPerPointStep =
      1e9 * wall_s / (static_cast<double>(result.stats.steps) * result.points());
  return result;
}

Json toJson(const ScalingResult& r) {
  return Json::Object{{"points", r.columns * r.rows},
                      {"columns", r.columns},
                      {"rows", r.rows},
                      {"threads", r.threads},
                      {"realtime_ratio", r.ratio},
                      {"frame_s", r.frame_s},
                      {"steps_per_frame", r.steps_per_frame},
                      {"ns_per_point_and_step", r.nsPerPointStep},
                      {"share_forces", r.share(r.stats.forces_s)},
                      {"share_constraints", r.share(r.stats.constraints_s)},
                      {"share_other", r.share(r.stats.other_s)},
                      {"bytes_per_point", r.bytesPerPoint},
                      {"max_penetration_m", r.stats.max_penetration_m},
                      {"max_edge_stretch", r.stats.max_edge_stretch}};
}

std::string toLine(const ScalingResult& r) {
  return fmt::format(
      "{:8} {:7} {:10.2f} {:10.3f} {:7.0f} {:9.2f} {:7.0f} {:6.0f} {:6.0f} {:8.0f} {:9.3f} {:7.2f}",
      r.columns * r.rows, r.threads, r.ratio, 1e3 * r.frame_s, r.steps_per_frame, r.nsPerPointStep,
      100 * r.share(r.stats.forces_s), 100 * r.share(r.stats.constraints_s),
      100 * r.share(r.stats.other_s), r.bytesPerPoint, 1e3 * r.stats.max_penetration_m,
      r.stats.max_edge_stretch);
}

void runScaling(const ScalingOptions& options, const Console& console) {
  const std::string file =
      options.character.empty() ? findExamples() + "/penguin.fascia.json" : options.character;
  console.say(machineLine());
  console.say(
      "                   × real      frame   steps  ns/point       % of time      bytes   deepest "
      " largest");
  console.say(
      "  points threads     time       (ms)  /frame     /step  forces constr.  other  /point      "
      "(mm)  stretch");
  Json::List results;
  for (const int points : options.points) {
    for (const int threads : options.threads) {
      const ScalingResult result =
          measure(file, gridOf(points, options.integrator), threads, options);
      console.say(toLine(result));
      results.push_back(toJson(result));
    }
  }
  console.answer(Json::Object{{"ok", true},
                              {"machine", machineInfo()},
                              {"seconds", options.seconds},
                              {"results", std::move(results)}});
}

}  // namespace

void addScalingBench(CLI::App& group, Console& console) {
  CLI::App& command = *group.add_subcommand("scaling", "Time and memory against skin points");
  const auto options = std::make_shared<ScalingOptions>();
  command.add_option("character", options->character, "Character file (default: the penguin)")
      ->transform(exampleFiles())
      ->type_name("CHARACTER");
  command.add_option("--motion", options->motion, "Motion to simulate (default: the first)")
      ->type_name("NAME");
  command
      .add_option("--integrator", options->integrator, "As of 'fascia bake' (default: the file's)")
      ->type_name("NAME");
  command.add_option("--points", options->points, "Skin points (default: 1024,10000,100000)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST")
      ->check(numberIn(64, 4e6));
  command.add_option("--threads", options->threads, "Threads (default: 1,2)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST")
      ->check(numberIn(1, 1024));
  command.add_option("--seconds", options->seconds, "Simulated seconds each (default: 2)")
      ->type_name("SECONDS")
      ->check(numberIn(0.1, 3600));
  console.addFlags(command);
  command.footer(kScalingFooter);
  command.callback([options, &console] { runScaling(*options, console); });
}

}  // namespace fascia
