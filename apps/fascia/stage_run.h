#pragma once

#include <span>
#include <string>
#include <vector>

#include <fascia/world/stage_recording.h>

#include "console.h"
#include "simulation_options.h"

namespace fascia {

// Reads and builds a scene for these options. Throws Error for options that scenes have no use for.
Stage prepareStage(const std::string& path, const SimulationOptions& options,
                   const Console& console);
StageRecordOptions stageRecordOptions(const SimulationOptions& options);

// Performs with a progress bar.
StageRecording perform(const Stage& stage, StageRecordOptions options, const Console& console);

// A line for each, up to a dozen.
void reportTroubles(const Stage& stage, std::span<const BodyTrouble> troubles,
                    const Console& console);
// Constraints that contradict each other as warnings, those that say something twice as notes.
// Returns how many contradict.
std::size_t reportRedundancies(std::span<const Redundancy> redundancies, const Console& console,
                               const std::string& file = {});
// A few lines about a performance for a person, the whole statistics for a machine. cache: the file
// that it was read from, if it did not happen now.
void reportPerformance(const Stage& stage, const StageRecording& recording,
                       const std::vector<std::string>& outputs, const Console& console,
                       const std::string& cache = {});

}  // namespace fascia
