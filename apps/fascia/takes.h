#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <fascia/character/recording.h>
#include <fascia/rig/cycle.h>

#include "console.h"
#include "simulation_options.h"

namespace fascia {

// Which motions of a character are to be simulated, and how they end.
struct TakeOptions {
  std::vector<std::string> motions;  // names or files (see motion_file.h); empty = the first
  std::string all;                   // "all": every motion of the character
  std::string loop;                  // auto, on or off; empty = auto

  void addTo(CLI::App& command);
};

// One motion to be simulated.
struct Take {
  std::string motion;  // its name; empty = the rest posture
  int index = -1;      // among the character's motions
  // A motion that ends as it begins is played twice, and the second time is kept: the flesh then
  // swings as it will when the motion repeats. `played` goes on for that long.
  int played = -1;
  std::optional<MotionCycle> cycle;
};

// A character and what it is to do.
struct Cast {
  CharacterDef def;  // as the file has it, with motions that were put onto its rig
  Character character;
  std::vector<Take> takes;
};
Cast prepareCast(const std::string& path, const TakeOptions& takes, SimulationOptions& options,
                 const Console& console);

struct Shot {
  Recording recording;
  // World frames of the rig's joints in every frame; empty without a rig.
  std::vector<std::vector<Transform>> joints_world;
  double gap_m = 0;  // of a cycle: how far its ends were apart before they were closed
  CharacterState last;
};
// Goes on from the state `from`, if one is given: not for cycles.
Shot shoot(const Cast& cast, const Take& take, const SimulationOptions& options,
           const Console& console, const CharacterState* from = nullptr);

// Where a motion's own file goes: "fox.glb" as it is for a single one, else "fox.Walk.glb".
std::string fileOf(const std::string& path, const std::vector<Take>& takes, std::size_t take);

}  // namespace fascia
