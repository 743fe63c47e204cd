#include <fascia/world/stage_recording.h>

#include <chrono>
#include <cmath>

namespace fascia {

StageRecording record(const Stage& stage, const StageRecordOptions& options) {
  const SceneSimulationDef& simulation = stage.def().simulation;
  StageRecording out;
  out.frame_rate_hz = options.frame_rate_hz > 0 ? options.frame_rate_hz : simulation.frame_rate_hz;
  const double duration_s = options.duration_s > 0 ? options.duration_s : simulation.duration_s;
  const double dt_s = 1 / out.frame_rate_hz;
  const auto frames = static_cast<std::int64_t>(std::llround(duration_s * out.frame_rate_hz));

  Performance performance(stage, options.seed);
  for (std::size_t i = 0; i < performance.characterCount(); ++i)
    out.characters.push_back(startRecording(performance.source(i), out.frame_rate_hz));
  const auto keep = [&] {
    const bool kept = performance.time_s() + 0.5 * dt_s >= options.start_s;
    if (kept) out.frames.push_back({performance.time_s(), performance.bodies().r});
    for (std::size_t i = 0; i < out.characters.size(); ++i)
      keepFrame(*stage.def().characters[i].character, performance.character(i), kept,
                out.characters[i]);
  };
  keep();
  for (std::int64_t i = 0; i < frames; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    performance.advance(dt_s);
    out.wall_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    out.simulated_s += dt_s;
    keep();
    if (options.progress &&
        !options.progress(static_cast<double>(i + 1) / static_cast<double>(frames)))
      throw Error("stopped");
  }
  for (std::size_t i = 0; i < out.characters.size(); ++i)
    finishRecording(*stage.def().characters[i].character, performance.character(i),
                    out.characters[i]);
  out.bodies = performance.bodyStats();
  out.troubles.assign(performance.troubles().begin(), performance.troubles().end());
  out.redundancies.assign(performance.redundancies().begin(), performance.redundancies().end());
  if (const Script* script = performance.script()) {
    out.outcome = script->outcome();
    out.reason = script->reason();
    out.log.assign(script->log().begin(), script->log().end());
  }
  out.state_hash = performance.hash();
  return out;
}

}  // namespace fascia
