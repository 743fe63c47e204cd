#pragma once

#include <functional>
#include <string>
#include <vector>

#include <fascia/character/recording.h>
#include <fascia/deformable/solve/body_stepper.h>
#include <fascia/world/performance.h>

namespace fascia {

// A performance, frame by frame: what a bake writes and a player reads.
struct StageRecording {
  struct Frame {
    double time_s = 0;
    std::vector<double> bodies;  // q of all of them: see BodyModel
  };
  double frame_rate_hz = 60;
  std::vector<Frame> frames;
  std::vector<Recording> characters;  // with the same frames, in the order of the scene
  BodyStepperStats bodies;
  ScriptOutcome outcome = ScriptOutcome::none;  // what the script says about it
  std::string reason;                           // of a failure
  std::vector<ScriptLogLine> log;
  std::vector<BodyTrouble> troubles;     // see Performance; of all frames, also those not kept
  std::vector<Redundancy> redundancies;  // likewise; none of a recording that was read
  double wall_s = 0, simulated_s = 0;
  std::uint64_t state_hash = 0;  // of the end
};

struct StageRecordOptions {
  std::uint64_t seed = 0;    // 0 = as the file says; others scatter the start
  double frame_rate_hz = 0;  // 0 = as in the file
  double duration_s = 0;     // 0 = as in the file
  double start_s = 0;        // frames before this are simulated, but not kept
  // Called after every frame with the fraction done; false stops (recording is then discarded).
  std::function<bool(double)> progress = {};
};

// Throws Error: of the script, or "stopped" when progress asked to stop.
StageRecording record(const Stage& stage, const StageRecordOptions& options);

}  // namespace fascia
