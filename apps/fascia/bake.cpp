#include <algorithm>
#include <filesystem>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>
#include <fascia/io/cache.h>
#include <fascia/io/gltf_writer.h>
#include <fascia/io/mdd.h>
#include <fascia/io/pc2.h>
#include <fascia/io/scene_file.h>
#include <fascia/io/stats_writer.h>

#include "commands.h"
#include "grid_bake.h"
#include "interrupt.h"
#include "motion_file.h"
#include "outputs.h"
#include "rig_bake.h"
#include "scene_bake.h"
#include "simulation_options.h"

namespace fascia {
namespace {

constexpr const char* kFooter = R"(Formats, by the ending of the file to write:
  .glb     glTF: skin, texture, skeleton, animation; plays in any viewer
  .pc2     point cache for Blender, Maya, Houdini
  .mdd     point cache for those and Cinema 4D
  .fcache  everything, exactly; 'fascia render' draws it without simulating again

Of a scene (see docs/scenes.md) a .glb has bodies, props and characters; point caches have all
surfaces as one.

A character on a rig (see 'fascia flesh') becomes its old file with the motion come alive, by --as:
  bones    helper bones and new weights: plays in every engine
  morphs   morph targets on top of the rig's own skinning
  cache    no skeleton; every vertex of every frame in a .pc2 and a .mdd beside the .glb

Examples:
  fascia bake examples/penguin.fascia.json -o penguin.glb
  fascia bake fox.fascia.json --motion Gallop -o fox_alive.glb --as bones --helpers 30
  fascia bake human.fascia.json --motion walk.bvh -o walk.glb
  fascia bake examples/sky-hook.fascia.json --seed 7 -o sky-hook.glb -o sky-hook.fcache
  fascia bake examples/penguin.fascia.json --motion hop -o hop.glb -o hop.fcache --stats hop.json
  fascia bake examples/penguin.fascia.json --grid 128x64 --fps 30 -o fine.pc2)";

struct BakeOptions {
  std::string file;  // a character or scene
  std::vector<std::string> outputs;
  std::string stats;
  SimulationOptions simulation;
  RigBakeOptions rig;
};

// Says how faithful a bake is, for a person; for a machine the same.
Json describe(const RigBakeReport& report, const RiggedModel& rig, const std::string& path,
              const Console& console) {
  const double percent = 0.1 / std::max(rig.height_m(), 1e-9);  // of the height, per millimetre
  const BakeError& error = report.error;
  console.say(fmt::format(
      "{}: {} added; error {:.3g} mm RMS, {:.3g} mm at most ({:.2g} % and {:.2g} % of the height)",
      path, report.added, error.rms_mm, error.max_mm, percent * error.rms_mm,
      percent * error.max_mm));
  return Json::Object{{"file", path},
                      {"added", static_cast<int>(report.added)},
                      {"rms_mm", error.rms_mm},
                      {"max_mm", error.max_mm},
                      {"rms_percent", percent * error.rms_mm},
                      {"max_percent", percent * error.max_mm}};
}

// One file, or several that belong together; fills in what was written.
void writeOutput(const Character& character, const Recording& recording, const std::string& path,
                 const BakeOptions& options, const Console& console,
                 std::vector<std::string>& written, Json::List& bakes) {
  const std::string ending = endingOf(path);
  if (ending == ".glb" && character.def().rig) {
    const RigBakeReport report = writeRigBake(character, recording, options.rig, path, console);
    bakes.push_back(describe(report, *character.def().rig->model, path, console));
    written.insert(written.end(), report.files.begin(), report.files.end());
    return;
  }
  if (ending == ".glb" && isSmallGridBake(character, options.rig)) {
    const std::span<const Recording> all(&recording, 1);
    const GridBakeReport report = writeGridBake(character, all, options.rig, path, console);
    for (Json& bake : describe(report, all, path, options.rig, console))
      bakes.push_back(std::move(bake));
  } else if (ending == ".glb") {
    writeGlb(character, recording, path);
  }
  if (ending == ".pc2") writePc2(recording, path);
  if (ending == ".mdd") writeMdd(recording, path);
  if (ending == ".fcache") writeCache(character.def(), recording, path);
  written.push_back(path);
}

// What the character is made of.
std::vector<std::string> inputsOf(const Character& character, const std::string& motionFile,
                                  const BakeOptions& options) {
  std::vector<std::string> out{options.file};
  if (const std::optional<RigDef>& rig = character.def().rig)
    out.push_back((std::filesystem::path(options.file).parent_path() / rig->file).string());
  if (!motionFile.empty()) out.push_back(motionFile);
  return out;
}

void bake(BakeOptions& options, const Console& console) {
  checkFolders(options.outputs);
  checkFolders({options.stats});
  const ThreadLimit threads(options.simulation.threads);
  if (isSceneFile(options.file)) {
    if (!options.rig.given().empty())
      throw Error("--as and its options are for characters on a rig");
    bakeScene({options.file, options.outputs, options.stats, options.simulation}, console);
    return;
  }
  const std::string motionFile =
      isMotionFile(options.simulation.motion) ? options.simulation.motion : std::string();
  const Character character = prepareCharacter(options.file, options.simulation, console);
  if (character.def().rig)
    checkRigBake(character, options.rig, options.outputs);
  else
    checkGridBake(character, options.rig, options.outputs);
  std::vector<std::string> files;
  for (const std::string& output : options.outputs)
    for (const std::string& file : filesOf(character, options.rig, output)) files.push_back(file);
  checkOverwriting(inputsOf(character, motionFile, options), files, options.stats);
  const Recording recording =
      simulate(character, options.simulation.recordOptions(character), console);
  std::vector<std::string> written;
  Json::List bakes;
  for (const std::string& path : options.outputs) {
    if (interruptSignal() != 0) throw Interrupted{};
    const std::size_t before = written.size();
    writeOutput(character, recording, path, options, console, written, bakes);
    for (std::size_t i = before; i < written.size(); ++i) console.say("wrote " + written[i]);
  }
  if (!options.stats.empty()) writeStats(recording, options.stats);
  reportRecording(recording, written, console,
                  bakes.empty() ? Json::Object{} : Json::Object{{"bakes", std::move(bakes)}});
}

}  // namespace

void addBake(CLI::App& program, Console& console) {
  CLI::App& command =
      *program.add_subcommand("bake", "Simulate a character or scene and save the animation");
  const auto options = std::make_shared<BakeOptions>();
  command.add_option("FILE", options->file, "A *.fascia.json file: a character or scene")
      ->required()
      ->type_name("");
  command.add_option("-o,--output", options->outputs, "File to write; may be given several times")
      ->required()
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->check(endsIn({".glb", ".pc2", ".mdd", ".fcache"}));
  command.add_option("--stats", options->stats, "Write how the simulation went to this JSON file")
      ->type_name("FILE");
  command
      .add_option("--fps", options->simulation.frame_rate_hz,
                  "Frames per second (default: as in the file)")
      ->type_name("HZ")
      ->check(numberIn(1, 1000));
  options->rig.addTo(command);
  options->simulation.addTo(command);
  console.addFlags(command);
  console.addVerboseFlag(command);
  command.footer(kFooter);
  command.callback([options, &console] { bake(*options, console); });
}

}  // namespace fascia
