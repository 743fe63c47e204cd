#include "state_files.h"

#include <fmt/format.h>

#include <fascia/io/state/state_file.h>

#include "outputs.h"

namespace fascia {
namespace {

std::string optionNames(const StateFiles& states) {
  if (states.from.empty()) return "--save-state";
  return states.save.empty() ? "--from-state" : "--from-state and --save-state";
}

}  // namespace

void StateFiles::addTo(CLI::App& command) {
  command
      .add_option("--save-state", save,
                  "Also write the state at the end, for --from-state: a .fstate file")
      ->type_name("FILE")
      ->check(endsIn({".fstate"}));
  command
      .add_option("--from-state", from,
                  "Go on from a saved state and its time, to the end of the motion or for "
                  "--duration")
      ->type_name("FILE");
}

void requireOnePlainMotion(const StateFiles& states, TakeOptions& takes) {
  if (!states.any()) return;
  if (takes.loop == "on")
    throw Error("--loop on plays a motion twice from its start; leave " + optionNames(states) +
                " out");
  takes.loop = "off";
}

void requireOneTake(const StateFiles& states, const Cast& cast) {
  if (states.any() && cast.takes.size() > 1)
    throw Error("a state is that of one motion: name one for " + optionNames(states));
}

std::optional<CharacterState> stateToGoOnFrom(const StateFiles& states, const Cast& cast,
                                              const SimulationOptions& options) {
  if (states.from.empty()) return std::nullopt;
  CharacterState state = readStateFile(cast.character, states.from);
  const double end_s = cast.character.source(cast.takes.front().played).info().duration_s;
  const double rate_hz =
      options.frame_rate_hz > 0 ? options.frame_rate_hz : cast.def.simulation.frame_rate_hz;
  if (options.duration_s <= 0 && (end_s - state.time_s) * rate_hz < 0.5)
    throw fileError(states.from,
                    fmt::format("is the state at {:.4g} s, and the motion ends at {:.4g} s",
                                state.time_s, end_s),
                    "--duration says how long to go on");
  return state;
}

}  // namespace fascia
