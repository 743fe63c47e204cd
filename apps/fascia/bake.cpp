#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>
#include <fascia/io/cache.h>
#include <fascia/io/character_file.h>
#include <fascia/io/gltf_writer.h>
#include <fascia/io/pc2.h>
#include <fascia/io/stats_writer.h>

#include "commands.h"
#include "interrupt.h"
#include "outputs.h"
#include "simulation_options.h"

namespace fascia {
namespace {

constexpr const char* kFooter = R"(Formats, by the ending of the file to write:
  .glb     glTF: skin, texture, skeleton, animation; plays in any viewer
  .pc2     point cache for Blender, Maya, Houdini
  .fcache  everything, exactly; 'fascia render' draws it without simulating again

Examples:
  fascia bake examples/penguin.fascia.json -o penguin.glb
  fascia bake examples/penguin.fascia.json --motion hop -o hop.glb -o hop.fcache --stats hop.json
  fascia bake examples/penguin.fascia.json --grid 128x64 --fps 30 -o fine.pc2)";

struct BakeOptions {
  std::string character;
  std::vector<std::string> outputs;
  std::string stats;
  SimulationOptions simulation;
};

void writeOutput(const Character& character, const Recording& recording, const std::string& path) {
  const std::string ending = endingOf(path);
  if (ending == ".glb") writeGlb(character, recording, path);
  if (ending == ".pc2") writePc2(recording, path);
  if (ending == ".fcache") writeCache(character.def(), recording, path);
}

void bake(const BakeOptions& options, const Console& console) {
  checkFolders(options.outputs);
  checkFolders({options.stats});
  const ThreadLimit threads(options.simulation.threads);
  const Character character = loadCharacter(options.character, options.simulation.buildOptions());
  const Recording recording =
      simulate(character, options.simulation.recordOptions(character), console);
  for (const std::string& path : options.outputs) {
    if (interruptSignal() != 0) throw Interrupted{};
    writeOutput(character, recording, path);
    console.say("wrote " + path);
  }
  if (!options.stats.empty()) writeStats(recording, options.stats);
  reportRecording(recording, options.outputs, console);
}

}  // namespace

void addBake(CLI::App& program, Console& console) {
  CLI::App& command = *program.add_subcommand("bake", "Simulate a motion and save the animation");
  const auto options = std::make_shared<BakeOptions>();
  command.add_option("CHARACTER", options->character, "A *.fascia.json file")
      ->required()
      ->type_name("");
  command.add_option("-o,--output", options->outputs, "File to write; may be given several times")
      ->required()
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->check(endsIn({".glb", ".pc2", ".fcache"}));
  command.add_option("--stats", options->stats, "Write how the simulation went to this JSON file")
      ->type_name("FILE");
  command
      .add_option("--fps", options->simulation.frame_rate_hz,
                  "Frames per second (default: as in the file)")
      ->type_name("HZ")
      ->check(numberIn(1, 1000));
  options->simulation.addTo(command);
  console.addFlags(command);
  command.footer(kFooter);
  command.callback([options, &console] { bake(*options, console); });
}

}  // namespace fascia
