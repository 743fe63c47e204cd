#include "stage_run.h"

#include <algorithm>

#include <fmt/core.h>

#include <fascia/io/documents/scene_file.h>
#include <fascia/io/documents/stats_writer.h>

#include "progress.h"

namespace fascia {
namespace {

// Options that would change nothing.
void checkScene(const Stage& stage, const SimulationOptions& options) {
  if (stage.def().characters.empty() && (!options.integrator.empty() || !options.grid.empty()))
    throw Error("--integrator and --grid are for skins, which this scene has none of");
  const double rate_hz =
      options.frame_rate_hz > 0 ? options.frame_rate_hz : stage.def().simulation.frame_rate_hz;
  if (options.step_s * rate_hz > 1 + 1e-9)
    throw Error(fmt::format("--step: found {:g}, expected at most a frame of the scene, {:.4g} s",
                            options.step_s, 1 / rate_hz));
}

}  // namespace

Stage prepareStage(const std::string& path, const SimulationOptions& options,
                   const Console& console) {
  if (!options.motion.empty() || !options.joint_map.empty())
    throw Error("--motion and --joint-map are for characters; those of a scene move as it says");
  if (options.step_s == 0)
    throw Error("--step 0 is for characters; bodies of a scene have a step of at most a frame");
  Stage stage = loadStage(path, options.buildOptions());
  console.warn(stage.warnings());
  checkScene(stage, options);
  return stage;
}

StageRecordOptions stageRecordOptions(const SimulationOptions& options) {
  StageRecordOptions out;
  out.seed = options.seed;
  out.frame_rate_hz = options.frame_rate_hz;
  out.duration_s = options.duration_s;
  return out;
}

StageRecording perform(const Stage& stage, StageRecordOptions options, const Console& console) {
  ProgressBar progress(console, "performing");
  options.progress = [&](double fraction) {
    progress.update(fraction);
    return true;
  };
  return record(stage, options);
}

void reportTroubles(const Stage& stage, std::span<const BodyTrouble> troubles,
                    const Console& console) {
  constexpr std::size_t kMostLines = 12;
  for (std::size_t i = 0; i < std::min(kMostLines, troubles.size()); ++i)
    console.hint(textOf(stage, troubles[i]));
  if (troubles.size() > kMostLines)
    console.hint(fmt::format("… and {} more: --stats has all of it", troubles.size() - kMostLines));
}

std::size_t reportRedundancies(std::span<const Redundancy> redundancies, const Console& console,
                               const std::string& file) {
  std::vector<Issue> conflicts;
  for (const Redundancy& redundancy : redundancies) {
    if (redundancy.contradicts())
      conflicts.push_back(
          {{file, {}, {}}, redundancy.text(), "they meet half-way: drop one, or move its place"});
    else
      console.hint("note: " + redundancy.text());
  }
  console.warn(conflicts);
  return conflicts.size();
}

void reportPerformance(const Stage& stage, const StageRecording& recording,
                       const std::vector<std::string>& outputs, const Console& console,
                       const std::string& cache) {
  for (const ScriptLogLine& line : recording.log)
    console.say(fmt::format("{:7.3f} s  {}", line.time_s, line.text));
  const double ratio = recording.wall_s > 0 ? recording.simulated_s / recording.wall_s : 0;
  const std::string origin =
      cache.empty() ? fmt::format("simulated {:.4g} s in {:.2g} s ({:.0f} × real time)",
                                  recording.simulated_s, recording.wall_s, ratio)
                    : "read from cache " + cache;
  console.say(fmt::format("{} frames, {} bodies: {}", recording.frames.size(),
                          stage.bodies().bodyCount(), origin));
  reportRedundancies(recording.redundancies, console);
  reportTroubles(stage, recording.troubles, console);
  if (recording.outcome == ScriptOutcome::succeeded) {
    if (anyFault(recording.troubles))
      console.hint("the script says that it has succeeded, with bodies that were not sound");
    else
      console.say("the script has succeeded");
  }
  if (recording.outcome == ScriptOutcome::failed)
    console.hint("the script has failed" +
                 (recording.reason.empty() ? std::string() : ": " + recording.reason));
  if (recording.bodies.stopped > 0)
    console.hint(fmt::format("{} steps were too hard and stood still: use a shorter \"step_s\"",
                             recording.bodies.stopped));
  Json::List written;
  for (const std::string& path : outputs) written.push_back(path);
  std::vector<Issue> issues;
  Json stats = parseJson(statsJson(stage, recording), JsonLimits{}, issues);
  console.answer(Json::Object{{"ok", true}, {"outputs", written}, {"stats", std::move(stats)}});
}

}  // namespace fascia
