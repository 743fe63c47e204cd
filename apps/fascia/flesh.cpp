#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/base/parallel.h>
#include <fascia/base/suggest.h>
#include <fascia/character/flesh_character.h>
#include <fascia/io/documents/character_file.h>
#include <fascia/io/file/file.h>
#include <fascia/io/rig_export/rig_copy.h>
#include <fascia/io/rig_import/rig_import.h>

#include "commands.h"
#include "console.h"
#include "example_files.h"
#include "input_kind.h"
#include "lively_motion.h"
#include "outputs.h"
#include "progress.h"
#include "shell_word.h"
#include "simulation_options.h"

namespace fascia {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFleshFooter =
    R"(Fills a rigged mesh with flesh: solids on its bones, under a layer of fat, inside of the skin.
The character file names the mesh's file, which must lie in the same folder or below it; if it does
not, a copy NAME.rig.glb is put beside the character file.

Examples:
  fascia flesh fox.glb -o fox.fascia.json
  fascia flesh fox.glb --jiggle 0.2 --muscle 0.8 -o soft_fox.fascia.json
  fascia flesh fox.glb --scale 0.01 --fat 0.25 -o small_fox.fascia.json)";

struct FleshOptions {
  std::string input, output, report;
  double scale = 1;
  FitOptions fit;
  SkinPoseDef dials;
  int threads = 0;
  bool force = false;
};

// "fox.fascia.json" -> "fox".
std::string nameOf(const fs::path& output) {
  std::string name = output.filename().string();
  for (const std::string ending : {".json", ".fascia"}) {
    if (name.size() > ending.size() && name.ends_with(ending))
      name.resize(name.size() - ending.size());
  }
  return name;
}

// The rig's path from the output's folder, if a character file there can name it.
std::optional<std::string> pathBelow(const fs::path& rig, const fs::path& folder) {
  const std::string ending = endingOf(rig.string());
  if (ending != ".glb" && ending != ".gltf" && ending != ".vrm") return std::nullopt;
  std::error_code fault;
  const fs::path real = fs::canonical(rig, fault), base = fs::canonical(folder, fault);
  if (fault) return std::nullopt;
  const fs::path relative = real.lexically_relative(base);
  if (relative.empty() || *relative.begin() == "..") return std::nullopt;
  return relative.generic_string();
}

struct RigFile {
  RigDef def;
  std::string copy;  // path of the copy to write; empty: none is needed
};

RigFile placeRig(const FleshOptions& options) {
  const fs::path output = options.output;
  const fs::path folder = output.has_parent_path() ? output.parent_path() : fs::path(".");
  RigFile rig;
  rig.def.scale = options.scale;
  if (const auto below = pathBelow(options.input, folder)) {
    rig.def.file = *below;
    return rig;
  }
  rig.def.file = nameOf(output) + ".rig.glb";
  rig.copy = (folder / rig.def.file).string();
  return rig;
}

void refuseToOverwrite(const std::string& path, bool force) {
  std::error_code fault;
  if (force || path.empty() || !fs::exists(path, fault)) return;
  Issue issue;
  issue.where.file = path;
  issue.message = "exists already";
  issue.hint = "--force overwrites it";
  throw Error(std::move(issue));
}

void sayJoint(const JointFit& joint, const Console& console) {
  if (joint.solids.empty()) {
    console.say(fmt::format("{:28} {:6} {:>6}   {}", joint.joint, joint.points, "-", joint.why));
    return;
  }
  console.say(fmt::format("{:28} {:6} {:6} {:7.0f} % {:6.1f} mm {:6.2f} mm", joint.joint,
                          joint.points, joint.solids.size(), 100 * joint.coverage,
                          1000 * joint.residual_rms_m, 1000 * joint.deepest_outside_m));
}

// How many of its points have no flesh beneath, about.
double bareOf(const JointFit& joint) {
  return static_cast<double>(joint.points) * (1 - joint.coverage);
}

// The joints with the most bare skin, in their order.
std::vector<const JointFit*> worstOf(const FleshFit& fit) {
  constexpr std::size_t kMostTold = 3;
  constexpr double kLeastBare = 0.05;  // of a joint's skin, to be told
  std::vector<const JointFit*> worst;
  for (const JointFit& joint : fit.joints)
    if (joint.points > 0 && 1 - joint.coverage > kLeastBare) worst.push_back(&joint);
  std::ranges::stable_sort(worst, std::greater{}, [](const JointFit* j) { return bareOf(*j); });
  worst.resize(std::min(worst.size(), kMostTold));
  std::ranges::sort(worst);
  return worst;
}

// The three worst places, or all with --verbose, and the whole.
void sayTable(const FleshFit& fit, const Console& console) {
  console.say(fmt::format("{:28} {:>6} {:>6} {:>9} {:>9} {:>9}", "joint", "points", "solids",
                          "coverage", "residual", "outside"));
  if (console.isVerbose()) {
    for (const JointFit& joint : fit.joints) sayJoint(joint, console);
  } else {
    for (const JointFit* joint : worstOf(fit)) sayJoint(*joint, console);
  }
  std::size_t points = 0;
  for (const JointFit& joint : fit.joints) points += joint.points;
  console.say(fmt::format("{:28} {:6} {:6} {:7.0f} % {:6.1f} mm {:6.2f} mm",
                          fmt::format("all {} joints", fit.joints.size()), points,
                          fit.flesh.solids.size(), 100 * fit.coverage, 1000 * fit.residual_rms_m,
                          1000 * fit.deepest_outside_m));
}

// Half a body without flesh is no success.
void warnOfBareBody(const FleshFit& fit, const std::string& input, const Console& console) {
  constexpr double kMostBare = 0.5;
  double points = 0, bare = 0;
  const JointFit* worst = nullptr;
  for (const JointFit& joint : fit.joints) {
    points += static_cast<double>(joint.points);
    if (!joint.solids.empty()) continue;
    bare += static_cast<double>(joint.points);
    if (!worst || joint.points > worst->points) worst = &joint;
  }
  const double share = std::max(bare / std::max(points, 1.0), 1 - fit.coverage);
  if (share < kMostBare) return;
  Issue issue;
  issue.where.file = input;
  issue.message = fmt::format("{:.0f} % of the body gets no flesh", 100 * share);
  if (worst && !worst->why.empty())
    issue.message += fmt::format("; at {}: {}", quotedName(worst->joint), worst->why);
  issue.hint =
      "are there walls of clothes without a body in them? A closed body is filled; -v shows "
      "every joint";
  console.warn({issue});
}

Json reportJson(const RiggedModel& model, const FleshFit& fit) {
  Json::List joints, notes;
  for (const JointFit& joint : fit.joints) {
    Json::List solids;
    for (const std::string& solid : joint.solids) solids.emplace_back(solid);
    Json entry = Json::Object{{"joint", joint.joint},
                              {"points", static_cast<double>(joint.points)},
                              {"solids", std::move(solids)},
                              {"coverage", joint.coverage},
                              {"residual_rms_m", joint.residual_rms_m},
                              {"deepest_outside_m", joint.deepest_outside_m}};
    if (!joint.why.empty()) entry.set("why", joint.why);
    joints.push_back(std::move(entry));
  }
  for (const std::string& note : model.notes) notes.emplace_back(note);
  for (const std::string& note : fit.notes) notes.emplace_back(note);
  return Json::Object{{"coverage", fit.coverage},
                      {"residual_rms_m", fit.residual_rms_m},
                      {"deepest_outside_m", fit.deepest_outside_m},
                      {"notes", std::move(notes)},
                      {"joints", std::move(joints)}};
}

void flesh(const FleshOptions& options, const Console& console) {
  checkFolders({options.output, options.report});
  refuseToOverwrite(options.output, options.force);
  RigFile rig = placeRig(options);
  checkOverwriting({options.output, rig.copy}, options.report);
  refuseToOverwrite(rig.copy, options.force);
  const ThreadLimit threads(options.threads);
  std::shared_ptr<const RiggedModel> shared;
  FleshedCharacter made;
  withInput(options.input, {.command = "flesh", .model = true}, [&] {
    shared = std::make_shared<const RiggedModel>(readRiggedModel(options.input, {options.scale}));
    ProgressBar progress(console, "fitting flesh");
    progress.update(0);  // how long it takes is not known
    made = fleshCharacter(shared, options.fit, options.dials);
  });
  const RiggedModel& model = *shared;
  const FleshFit& fit = made.fit;
  sayTable(fit, console);
  warnOfBareBody(fit, options.input, console);
  for (const auto& notes : {model.notes, fit.notes}) {
    for (const std::string& note : notes) console.say("note: " + note);
  }
  const Json report = reportJson(model, fit);
  if (!options.report.empty()) writeFileWhole(options.report, printJson(report));
  if (!rig.copy.empty()) {
    rig.def.scale = copyRig(model, options.scale, rig.copy);
    console.say("wrote " + rig.copy);
  }
  made.def.name = nameOf(options.output);
  made.def.rig = rig.def;
  writeCharacterFile(made.def, options.output);
  console.say("wrote " + options.output);
  const std::string character = shellWord(options.output), name = nameOf(options.output);
  console.say(fmt::format("next: fascia render {} --layers muscle,skeleton -o {}", character,
                          shellWord(name + ".png")));
  console.say(fmt::format("      fascia bake {}{} -o {}", character,
                          motionOption(livelyMotion(model)), shellWord(name + ".alive.glb")));
  console.answer(Json::Object{{"ok", true}, {"output", options.output}, {"fit", report}});
}

}  // namespace

void addFlesh(CLI::App& program, Console& console) {
  CLI::App& command =
      *program.add_subcommand("flesh", "Fill a rigged mesh with flesh: a character of it");
  const auto options = std::make_shared<FleshOptions>();
  command.add_option("INPUT", options->input, "A rigged mesh: .glb, .gltf, .fbx, …")
      ->required()
      ->transform(exampleFiles())
      ->type_name("");
  command.add_option("-o,--output", options->output, "Character file to write: *.fascia.json")
      ->required()
      ->type_name("FILE")
      ->check(endsIn({".json"}));
  command.add_option("--scale", options->scale, "Of all lengths; 0.01 for a file in centimetres")
      ->type_name("FACTOR")
      ->check(numberIn(1e-6, 1e6));
  command
      .add_option("--fat", options->fit.fat_share,
                  "Thickness of fat as a share of the body's local radius")
      ->type_name("SHARE")
      ->check(numberIn(0.01, 0.9))
      ->capture_default_str();
  const auto dial = [&](const std::string& name, double& value, const std::string& help) {
    command.add_option(name, value, help)
        ->type_name("0…1")
        ->check(numberIn(0, 1))
        ->capture_default_str();
  };
  dial("--jiggle", options->dials.jiggle, "Flesh that moves by itself: 0 none, 1 jelly");
  dial("--muscle", options->dials.muscle, "Muscles that swell in a bend: 0 none, 1 bodybuilder");
  dial("--volume", options->dials.volume, "Share of what a bend takes that comes out around it");
  dial("--tightness", options->dials.tightness, "How far the skin evens out: 0 slack, 1 taut");
  command.add_flag("--simulate", options->dials.simulate,
                   "Put a simulated elastic skin on top, of a material that suits the mesh");
  command.add_option("--report", options->report, "Write the table to this JSON file")
      ->type_name("FILE");
  command
      .add_option("--threads", options->threads, "Threads to use; 0 = all. The result is the same")
      ->type_name("N")
      ->check(numberIn(0, 1024));
  command.add_flag("--force", options->force, "Overwrite files");
  console.addFlags(command);
  console.addVerboseFlag(command);
  command.footer(kFleshFooter);
  command.callback([options, &console] { flesh(*options, console); });
}

}  // namespace fascia
