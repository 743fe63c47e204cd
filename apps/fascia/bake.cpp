#include <algorithm>
#include <optional>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>
#include <fascia/io/cache/cache.h>
#include <fascia/io/cache/mdd.h>
#include <fascia/io/cache/pc2.h>
#include <fascia/io/documents/scene_file.h>
#include <fascia/io/documents/stats_writer.h>
#include <fascia/io/file/inputs.h>
#include <fascia/io/glb_export/gltf_writer.h>
#include <fascia/io/rig_export/rig_writer.h>
#include <fascia/io/state/state_file.h>

#include "commands.h"
#include "example_files.h"
#include "grid_bake.h"
#include "input_kind.h"
#include "outputs.h"
#include "rig_bake.h"
#include "scene_bake.h"
#include "shell_word.h"
#include "simulation_options.h"
#include "state_files.h"
#include "takes.h"

namespace fascia {
namespace {

constexpr const char* kBakeFooter = R"(Formats, by the ending of the file to write:
  .glb     glTF: skin, texture, skeleton, animation; plays in any viewer
  .vrm     the same, for a character that came from a .vrm: stays an avatar
  .pc2     point cache for Blender, Maya, Houdini
  .mdd     point cache for those and Cinema 4D
  .fcache  everything, exactly; 'fascia render' draws it without simulating again

Of a scene (see docs/scenes.md) a .glb has bodies, props and characters; point caches have all
surfaces as one.

A character on a rig (see 'fascia flesh') becomes its old file with the motion come alive, by --as:
  bones    helper bones and new weights: plays in every engine
  morphs   morph targets on top of the rig's own skinning
  cache    no skeleton; every vertex of every frame in a .pc2 and a .mdd beside the .glb

A character whose skin lies on its solids becomes a small .glb of one or more motions, by --as:
  morphs   weights for its joints and morph targets on top (what it does if nothing is said)
  bones    weights for its joints and helper bones
  cache    every vertex of every frame, a morph target each

Examples:
  fascia bake examples/penguin.fascia.json -o penguin.glb
  fascia flesh fox.glb -o fox.fascia.json
  fascia bake fox.fascia.json --motion Run -o fox_alive.glb
  fascia bake fox.fascia.json --motion Run --motion Jump --helpers 30 -o fox_both.glb
  fascia bake examples/penguin.fascia.json --motions all --targets 32 -o penguin_all.glb
  fascia bake examples/sky-hook.fascia.json --seed 7 -o sky-hook.glb -o sky-hook.fcache
  fascia bake examples/penguin.fascia.json --motion waddle -o waddle.fcache --stats waddle.json
  fascia bake examples/penguin.fascia.json --duration 3 -o a.glb --save-state a.fstate
  fascia bake examples/penguin.fascia.json --from-state a.fstate -o b.glb
  fascia bake examples/penguin.fascia.json --grid 128x64 --fps 30 -o fine.pc2)";

struct BakeOptions {
  std::string file;  // a character or scene
  std::vector<std::string> outputs;
  std::string stats;
  TakeOptions takes;
  SimulationOptions simulation;
  RigBakeOptions rig;
  StateFiles states;
};

// What a bake has made so far.
struct Made {
  std::vector<std::string> written;
  Json::List bakes;
};

// One file for all motions: what only a .glb with a skeleton can be, and not as a cache.
bool holdsAll(const Cast& cast, const RigBakeOptions& options, const std::string& path) {
  if (!isGlb(path)) return false;
  return cast.def.rig ? options.as != "cache" : isSmallGridBake(cast.character, options);
}

void writeRig(const Cast& cast, std::span<const Shot> shots, const std::string& path,
              const BakeOptions& options, const Console& console, Made& made) {
  const RigBakeReport report = writeRigBake(cast.def, shots, options.rig, path, console);
  made.bakes.push_back(describe(report, options.rig, *cast.def.rig->model, path, console));
  made.written.insert(made.written.end(), report.files.begin(), report.files.end());
}

void writeGrid(const Cast& cast, std::span<const Shot> shots, const std::string& path,
               const BakeOptions& options, const Console& console, Made& made) {
  std::vector<const Recording*> recordings;
  for (const Shot& shot : shots) recordings.push_back(&shot.recording);
  const GridBakeReport report =
      writeGridBake(cast.character, recordings, options.rig, path, console);
  made.bakes.push_back(describe(report, recordings, options.rig, path, console));
  made.written.push_back(path);
}

// One motion in a file of its own, or in several that belong together.
void writeMotion(const Cast& cast, const Shot& shot, const std::string& path,
                 const BakeOptions& options, const Console& console, Made& made) {
  const std::string ending = endingOf(path);
  if (isGlb(path) && cast.def.rig) {
    writeRig(cast, {&shot, 1}, path, options, console, made);
    return;
  }
  if (ending == ".glb") writeGlb(cast.character, shot.recording, path);
  if (ending == ".pc2") writePc2(shot.recording, path);
  if (ending == ".mdd") writeMdd(shot.recording, path);
  if (ending == ".fcache") writeCache(cast.def, shot.recording, path);
  made.written.push_back(path);
}

void writeOutput(const Cast& cast, const std::vector<Shot>& shots, const std::string& path,
                 const BakeOptions& options, const Console& console, Made& made) {
  const std::size_t before = made.written.size();
  if (holdsAll(cast, options.rig, path)) {
    const auto write = cast.def.rig ? writeRig : writeGrid;
    write(cast, shots, path, options, console, made);
  } else {
    for (std::size_t k = 0; k < shots.size(); ++k)
      writeMotion(cast, shots[k], fileOf(path, cast.takes, k), options, console, made);
  }
  for (std::size_t i = before; i < made.written.size(); ++i)
    console.say("wrote " + made.written[i]);
}

// Throws Error if a .vrm is to be written of what is none; nullptr: not of a rig's file.
void checkVrm(const RiggedModel* rig, const std::vector<std::string>& outputs) {
  for (const std::string& output : outputs) {
    if (endingOf(output) != ".vrm" || (rig && isVrm(*rig))) continue;
    Issue issue;
    issue.where.file = output;
    issue.message = "would be no avatar: a .vrm is written of characters that came from one";
    issue.hint = "name it .glb";
    throw Error(std::move(issue));
  }
}

// Throws Error before any long work if a file would be overwritten.
void checkFiles(const Cast& cast, const BakeOptions& options) {
  std::vector<std::string> files;
  for (const std::string& output : options.outputs) {
    const std::size_t count = holdsAll(cast, options.rig, output) ? 1 : cast.takes.size();
    for (std::size_t k = 0; k < count; ++k) {
      const std::string path = count > 1 ? fileOf(output, cast.takes, k) : output;
      for (const std::string& file : filesOf(cast.character, options.rig, path))
        files.push_back(file);
    }
  }
  if (!options.stats.empty())
    for (std::size_t k = 1; k < cast.takes.size(); ++k)
      files.push_back(fileOf(options.stats, cast.takes, k));
  if (!options.states.save.empty()) files.push_back(options.states.save);
  if (!options.states.from.empty()) noteInput(options.states.from);
  checkOverwriting(files, options.stats.empty() ? "" : fileOf(options.stats, cast.takes, 0));
}

std::vector<Shot> shootAll(const Cast& cast, const BakeOptions& options, const Console& console) {
  const std::optional<CharacterState> from =
      stateToGoOnFrom(options.states, cast, options.simulation);
  std::vector<Shot> shots;
  for (const Take& take : cast.takes) {
    shots.push_back(shoot(cast, take, options.simulation, console, from ? &*from : nullptr));
    if (!take.cycle) continue;
    console.detail(fmt::format("{}: a cycle; its ends were {:.2g} mm apart, and meet now",
                               take.motion, 1e3 * shots.back().gap_m));
  }
  return shots;
}

void bakeCharacter(BakeOptions& options, const Console& console) {
  requireOnePlainMotion(options.states, options.takes);
  const Cast cast = prepareCast(options.file, options.takes, options.simulation, console);
  requireOneTake(options.states, cast);
  checkRigBake(cast.character, options.rig, options.outputs);
  checkVrm(cast.def.rig && options.rig.as != "cache" ? cast.def.rig->model.get() : nullptr,
           options.outputs);
  checkFiles(cast, options);
  const std::vector<Shot> shots = shootAll(cast, options, console);
  Made made;
  for (const std::string& path : options.outputs) {
    writeOutput(cast, shots, path, options, console, made);
  }
  if (!options.states.save.empty()) {
    writeStateFile(cast.character, shots.front().last, options.states.save);
    made.written.push_back(options.states.save);
    console.say("wrote " + options.states.save);
  }
  std::vector<const Recording*> recordings;
  for (std::size_t k = 0; k < shots.size(); ++k) {
    recordings.push_back(&shots[k].recording);
    if (!options.stats.empty())
      writeStats(shots[k].recording, fileOf(options.stats, cast.takes, k));
  }
  Json::Object more;
  if (!made.bakes.empty()) more.push_back({"bakes", std::move(made.bakes)});
  reportRecordings(recordings, made.written, console, more);
  for (const std::string& file : made.written) {
    if (endingOf(file) != ".fcache") continue;
    console.say(fmt::format("next: fascia render {} -o {}", shellWord(file),
                            shellWord(file.substr(0, file.size() - 7) + ".mp4")));
    break;
  }
}

void bakeFile(BakeOptions& options, const Console& console) {
  if (!isSceneFile(options.file)) {
    bakeCharacter(options, console);
    return;
  }
  checkVrm(nullptr, options.outputs);
  if (!options.rig.given().empty()) throw Error("--as and its options are for characters on a rig");
  if (!options.takes.motions.empty() || !options.takes.all.empty() || !options.takes.loop.empty())
    throw Error("--motion, --motions and --loop are for characters; a scene has its own");
  if (options.states.any())
    throw Error(
        "--save-state and --from-state are for characters; the state of a scene, with its "
        "script, cannot be saved");
  bakeScene({options.file, options.outputs, options.stats, options.simulation}, console);
}

void bake(BakeOptions& options, const Console& console) {
  checkFolders(options.outputs);
  checkFolders({options.stats, options.states.save});
  checkOverwriting(options.outputs, options.stats);
  const ThreadLimit threads(options.simulation.threads);
  withInput(options.file, {.command = "bake", .character = true, .scene = true},
            [&] { bakeFile(options, console); });
}

}  // namespace

void addBake(CLI::App& program, Console& console) {
  CLI::App& command =
      *program.add_subcommand("bake", "Simulate a character or scene and save the animation");
  const auto options = std::make_shared<BakeOptions>();
  command.add_option("FILE", options->file, "A *.fascia.json file: a character or scene")
      ->required()
      ->transform(exampleFiles())
      ->type_name("");
  command.add_option("-o,--output", options->outputs, "File to write; may be given several times")
      ->required()
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->check(endsIn({".glb", ".pc2", ".mdd", ".fcache", ".vrm"}));
  command.add_option("--stats", options->stats, "Write how the simulation went to this JSON file")
      ->type_name("FILE");
  command
      .add_option("--fps", options->simulation.frame_rate_hz,
                  "Frames per second (default: as in the file)")
      ->type_name("HZ")
      ->check(numberIn(1, 1000));
  options->rig.addTo(command);
  options->takes.addTo(command);
  options->simulation.addTo(command);
  options->states.addTo(command);
  console.addFlags(command);
  console.addVerboseFlag(command);
  command.footer(kBakeFooter);
  command.callback([options, &console] { bake(*options, console); });
}

}  // namespace fascia
