#pragma once

#include <cstdint>
#include <string>

#include <CLI/CLI.hpp>

#include <fascia/character/character.h>
#include <fascia/character/recording.h>
#include <fascia/io/documents/character_file.h>

#include "console.h"

namespace fascia {

// What a person may say about a simulation without touching the character's file.
struct SimulationOptions {
  std::string motion;        // name; empty = the character's first; or a file (see motion_file.h)
  std::string joint_map;     // a file for the latter; empty = guessed
  double frame_rate_hz = 0;  // 0 = as in the file
  double duration_s = 0;     // 0 = the motion's
  std::string integrator;    // empty = as in the file
  double step_s = -1;        // negative = as in the file
  std::string grid;          // "COLUMNSxROWS"; empty = as in the file
  int threads = 0;           // 0 = all the machine has
  std::uint64_t seed = 0;    // of a scene: 0 = the start as in the file, others scatter it

  // All but the frame rate, which commands name differently, and the motion, of which some take
  // several.
  void addTo(CLI::App& command);
  void addMotionTo(CLI::App& command);
  BuildOptions buildOptions() const;
  RecordOptions recordOptions() const;
};

struct Size {
  int width = 0, height = 0;
};
// "640x360"; {0, 0} for any other text.
Size parseSize(const std::string& text);
// For CLI11: empty, or what is wrong with the text as a size whose sides are in [low, high].
std::string sizeProblem(const std::string& text, int low, int high);

// A CLI11 check whose range stays out of the help.
CLI::Validator numberIn(double low, double high);
// … out of a parser that throws.
template <class Parser>
std::function<std::string(const std::string&)> parsedBy(Parser parse) {
  return [parse](const std::string& text) -> std::string {
    try {
      parse(text);
      return {};
    } catch (const Error& error) {
      return error.what();
    }
  };
}

// Reads and builds a character for these options. A motion capture file among them is put onto its
// rig first; they then name the motion that came of it.
Character prepareCharacter(const std::string& path, SimulationOptions& options,
                           const Console& console);
// The same of a file that is read already.
Character prepareCharacter(CharacterFile file, SimulationOptions& options, const Console& console);

// The index of the motion to use; -1 = the character has none. Throws for an unknown name.
int chooseMotion(const Character& character, const std::string& name);

// Simulates a motion (-1: the rest posture) with a progress bar.
Recording simulate(const Character& character, int motion, RecordOptions options,
                   const Console& console, const std::string& what = "simulating");

}  // namespace fascia
