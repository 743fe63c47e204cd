#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <fascia/character/editing.h>
#include <fascia/io/documents/character_file.h>

#include "bench/benches.h"
#include "bench/machine.h"
#include "console.h"
#include "example_files.h"
#include "simulation_options.h"

namespace fascia {
namespace {

constexpr const char* kEditingFooter =
    R"(Edits a character while it moves: how long it takes until the next frame can start (the edited
character and the state carried over), and what the first frame afterwards costs beside a usual
one. Medians of many edits. An imported rig has the points that it has.

Examples:
  fascia bench editing
  fascia bench editing examples/wombat.fascia.json --points 10000
  fascia flesh fox.glb -o fox.fascia.json && fascia bench editing fox.fascia.json)";

struct EditingOptions {
  std::string file;
  std::vector<int> points{1024, 10000};
  std::vector<std::string> only;  // names of edits; empty: all
  int repeats = 41;
};

// Changes something by a little; `n` counts up, so that no two edits in a row are the same.
struct Edit {
  std::string name;
  std::function<void(CharacterDef&, int n)> apply;
};

double wave(int n) {
  return std::sin(0.7 * n);
}

void resizeSolid(CharacterDef& d, int n) {
  // One that no driver sizes.
  const auto solid = std::ranges::find_if(d.flesh.solids,
                                          [](const FleshSolidDef& s) { return s.drivers.empty(); });
  if (solid == d.flesh.solids.end()) return;
  const Shape& shape = *findShape(solid->solid.shape);
  std::vector<double>& p = solid->solid.parameters;
  for (std::size_t i = p.size(); i < shape.parameters().size(); ++i)
    p.push_back(shape.parameters()[i].standard);
  p[0] *= 1 + 0.01 * std::cos(0.7 * n);
}

void moveJoint(CharacterDef& d, int n) {
  const auto joint =
      std::ranges::find(d.skeleton.joints, d.flesh.solids.back().joint, &JointDef::name);
  joint->offset_m.y() += 0.002 * wave(n);
}

// Of all skins.
std::vector<Edit> edits() {
  return {
      {"material",
       [](CharacterDef& d, int n) { d.skin->material.stretch_u_N_per_m = 80 + 5 * wave(n); }},
      {"tissue",
       [](CharacterDef& d, int n) { d.skin->tissue.stiffness_N_per_m3 = 6000 + 300 * wave(n); }},
      {"fat", [](CharacterDef& d, int n) { d.skin->fat.thickness_m = 0.01 + 0.001 * wave(n); }},
      {"solid moved",
       [](CharacterDef& d, int n) { d.flesh.solids[0].position_m.x() = 0.01 * wave(n); }},
      {"solid resized", resizeSolid},
      {"joint moved", moveJoint},
  };
}

std::vector<Edit> gridEdits() {
  return {
      {"joint renamed",
       [](CharacterDef& d, int n) {
         renameJoint(d, d.skeleton.joints.back().name, "joint " + std::to_string(n));
       }},
      {"wrapped anew", [](CharacterDef& d, int n) { d.skin->grid.cling = 0.12 + 0.01 * wave(n); }},
  };
}

std::vector<Edit> rigEdits() {
  return {
      {"jiggle", [](CharacterDef& d, int n) { d.skin->mesh.pose.jiggle = 0.5 + 0.1 * wave(n); }},
      {"muscle", [](CharacterDef& d, int n) { d.skin->mesh.pose.muscle = 0.5 + 0.1 * wave(n); }},
      {"volume", [](CharacterDef& d, int n) { d.skin->mesh.pose.volume = 0.5 + 0.1 * wave(n); }},
      {"tightness",
       [](CharacterDef& d, int n) { d.skin->mesh.pose.tightness = 0.5 + 0.1 * wave(n); }},
      {"brush of fat",
       [](CharacterDef& d, int n) {
         d.skin->brushes = {{SkinQuantity::fat, Vec3::Zero(), d.skeleton.joints.back().name, 0.05,
                             0.005 + 0.001 * wave(n)}};
       }},
  };
}

double since_ms(std::chrono::steady_clock::time_point begin) {
  return 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Medians over the edits of one kind.
struct Times {
  double edit_ms = 0, carry_ms = 0, firstFrame_ms = 0, frame_ms = 0;
};

Times measure(const Character& start, const Edit& edit, int repeats) {
  Character character = start;
  CharacterState state = initialState(character, character.source(0));
  SkinStats stats;
  const auto frame = [&] {
    const auto begin = std::chrono::steady_clock::now();
    advance(character, character.source(0), 1.0 / 60, state, stats);
    return since_ms(begin);
  };
  std::vector<double> all[4];
  frame();
  for (int n = 0; n < repeats; ++n) {
    CharacterDef next = character.def();
    edit.apply(next, n);
    auto begin = std::chrono::steady_clock::now();
    Character edited = character.edited(next);
    all[0].push_back(since_ms(begin));
    begin = std::chrono::steady_clock::now();
    state = carryOver(character, state, edited);
    all[1].push_back(since_ms(begin));
    character = std::move(edited);
    all[2].push_back(frame());
    all[3].push_back(frame());
  }
  return {median(all[0]), median(all[1]), median(all[2]), median(all[3])};
}

Character loadWithPoints(const std::string& file, int points) {
  BuildOptions build;
  build.columns = build.rows = static_cast<int>(std::lround(std::sqrt(points)));
  Character character = loadCharacter(file, build);
  if (!character.skin() || character.motionCount() == 0)
    throw Error(file + ": needs a skin and a motion");
  return character;
}

Json measureAll(const Character& character, const EditingOptions& options, const Console& console) {
  const std::string name = character.def().name;
  Json::List rows;
  std::vector<Edit> all = edits();
  for (Edit& more : character.skin()->grid() ? gridEdits() : rigEdits())
    all.push_back(std::move(more));
  for (const Edit& edit : all) {
    if (!options.only.empty() && std::ranges::find(options.only, edit.name) == options.only.end())
      continue;
    const Times t = measure(character, edit, options.repeats);
    console.say(fmt::format(
        "{} {:>6}  {:<14} {:7.2f} ms to edit, {:6.2f} ms to go on; first frame {:7.2f} ms, usual "
        "{:7.2f} ms",
        name, character.skin()->pointCount(), edit.name, t.edit_ms, t.carry_ms, t.firstFrame_ms,
        t.frame_ms));
    rows.push_back(Json::Object{{"edit", edit.name},
                                {"edit_ms", t.edit_ms},
                                {"carry_over_ms", t.carry_ms},
                                {"first_frame_ms", t.firstFrame_ms},
                                {"frame_ms", t.frame_ms}});
  }
  return Json::Object{{"character", name},
                      {"points", static_cast<int>(character.skin()->pointCount())},
                      {"edits", std::move(rows)}};
}

void runEditing(const EditingOptions& options, const Console& console) {
  const std::string file =
      options.file.empty() ? findExamples() + "/penguin.fascia.json" : options.file;
  console.say(machineLine());
  Json::List results;
  for (const int points : options.points) {
    const Character character = loadWithPoints(file, points);
    results.push_back(measureAll(character, options, console));
    if (!character.skin()->grid()) break;  // a mesh has the points that it has
  }
  console.answer(
      Json::Object{{"ok", true}, {"machine", machineInfo()}, {"results", std::move(results)}});
}

}  // namespace

void addEditingBench(CLI::App& group, Console& console) {
  CLI::App& command = *group.add_subcommand("editing", "What edits cost while a character moves");
  const auto options = std::make_shared<EditingOptions>();
  command.add_option("FILE", options->file, "Character file (default: the penguin)")->type_name("");
  command.add_option("--points", options->points, "Skin points (default: 1024 10000)")
      ->type_name("N")
      ->check(numberIn(64, 1e6));
  command.add_option("--edit", options->only, "Only these, as the table names them")
      ->type_name("NAME");
  command.add_option("--repeats", options->repeats, "Edits of each kind (default: 41)")
      ->type_name("N")
      ->check(numberIn(1, 1e4));
  console.addFlags(command);
  command.footer(kEditingFooter);
  command.callback([options, &console] { runEditing(*options, console); });
}

}  // namespace fascia
