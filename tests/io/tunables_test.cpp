// Reader, builder, schema and documentation of everything that a person can set agree, because they
// are made from the same tables.

#include <gtest/gtest.h>

#include <functional>
#include <map>

#include <nlohmann/json.hpp>

#include <fascia/io/documents/all_tunables.h>
#include <fascia/io/documents/scene_file.h>
#include <fascia/io/documents/tunables_page.h>
#include <fascia/io/file/file.h>

#include "sample.h"

namespace fascia {
namespace {

using nlohmann::json;
using Found = std::map<std::string, std::string>;  // message of a fault by its pointer

// Every object that has a table, once, and nothing that keeps it from being built.
const json kTunedCharacter = json::parse(R"({
  "fascia": 1,
  "name": "arm",
  "skeleton": [
    {"name": "shoulder", "offset_m": [0, 1, 0], "orientation_deg": [0, 0, 0]},
    {"name": "elbow", "parent": "shoulder", "offset_m": [0, -0.3, 0], "dofs": {"rx": [-90, 90]}}
  ],
  "solids": [
    {"name": "upper", "joint": "shoulder", "shape": "sphere", "radius_m": 0.2, "position_m": [0, 0, 0],
     "orientation_deg": [0, 0, 0], "soft": {}},
    {"name": "lower", "joint": "elbow", "shape": "sphere", "radius_m": 0.2}
  ],
  "skin": {
    "grid": [8, 8],
    "bottom": {"joint": "elbow", "position_m": [0, 0, 0], "axis": [0, -1, 0]},
    "top": {"joint": "shoulder"},
    "material": {}, "fat": {}, "tissue": {}, "pose": {}, "contact": {},
    "regions": [{"name": "all", "edits": [{"quantity": "fat", "value": 0.01}]}],
    "brushes": [{"joint": "elbow", "center_m": [0, 0, 0]}],
    "anchors": [{"u": 0.5, "v": 0.5, "solid": "lower", "position_m": [0, 0, 0]}]
  },
  "motions": [
    {"name": "flex", "tracks": [{"joint": "elbow", "dof": "rx", "keys": [{"t_s": 0, "value_deg": 1}]}]}
  ],
  "simulation": {"gravity_m_per_s2": [0, 0, 0]}
})");

const json kTunedScene = json::parse(R"({
  "fascia": 1,
  "kind": "scene",
  "name": "scene",
  "bodies": [
    {"name": "ball", "shape": "sphere", "radius_m": 0.2, "position_m": [0, 0, 0],
     "orientation_deg": [0, 0, 0], "velocity_m_per_s": [0, 0, 0], "spin_deg_per_s": [0, 0, 0],
     "scatter": {"position_m": [0, 0, 0], "orientation_deg": [0, 0, 0], "velocity_m_per_s": [0, 0, 0]}}
  ],
  "constraints": [{"type": "nail", "points": ["ball"], "direction": [0, 1, 0]}],
  "paths": [
    {"point": "ball",
     "keys": [{"time_s": 1, "position_m": [0, 0, 0], "velocity_m_per_s": [0, 0, 0],
               "leaving_m_per_s": [0, 0, 0]}]}
  ],
  "characters": [{"name": "doll", "file": "doll.fascia.json", "position_m": [0, 0, 0]}],
  "props": [
    {"name": "post", "shape": "sphere", "radius_m": 0.1, "position_m": [0, 0, 0],
     "orientation_deg": [0, 0, 0]}
  ],
  "ground": {},
  "view": {"low_m": [0, 0, 0], "high_m": [1, 1, 1]},
  "simulation": {"gravity_m_per_s2": [0, 0, 0]}
})");

std::string firstOf(std::string place) {
  for (std::size_t at; (at = place.find('*')) != std::string::npos;) place.replace(at, 1, "0");
  return place;
}

// The object of a table in a definition that holds all of them.
template <class Def>
Def& objectIn(CharacterDef& def) {
  if constexpr (std::is_same_v<Def, JointDef>) return def.skeleton.joints[0];
  if constexpr (std::is_same_v<Def, FleshSolidDef>) return def.flesh.solids[0];
  if constexpr (std::is_same_v<Def, SoftSolidDef>) return *def.flesh.solids[0].soft;
  if constexpr (std::is_same_v<Def, RigDef>) return *def.rig;
  if constexpr (std::is_same_v<Def, SkinGridDef>) return def.skin->grid;
  if constexpr (std::is_same_v<Def, SkinEndDef>) return def.skin->grid.bottom;
  if constexpr (std::is_same_v<Def, SkinMaterialDef>) return def.skin->material;
  if constexpr (std::is_same_v<Def, SkinFatDef>) return def.skin->fat;
  if constexpr (std::is_same_v<Def, SkinTissueDef>) return def.skin->tissue;
  if constexpr (std::is_same_v<Def, SkinPoseDef>) return def.skin->mesh.pose;
  if constexpr (std::is_same_v<Def, SkinRegionDef>) return def.skin->regions[0];
  if constexpr (std::is_same_v<Def, SkinRegionDef::Edit>) return def.skin->regions[0].edits[0];
  if constexpr (std::is_same_v<Def, SkinBrushDef>) return def.skin->brushes[0];
  if constexpr (std::is_same_v<Def, SkinAnchorDef>) return def.skin->grid.anchors[0];
  if constexpr (std::is_same_v<Def, SkinContactDef>) return def.skin->contact;
  if constexpr (std::is_same_v<Def, SkinPartDef>) return def.skin->mesh.parts[0];
  if constexpr (std::is_same_v<Def, MotionDef>) return def.motions[0];
  if constexpr (std::is_same_v<Def, Key>) return def.motions[0].tracks[0].keys[0];
  if constexpr (std::is_same_v<Def, SimulationDef>) return def.simulation;
}
template <class Def>
Def& objectIn(SceneDef& def) {
  if constexpr (std::is_same_v<Def, SceneBodyDef>) return def.bodies[0];
  if constexpr (std::is_same_v<Def, ScatterDef>) return def.bodies[0].scatter;
  if constexpr (std::is_same_v<Def, SceneConstraintDef>) return def.constraints[0];
  if constexpr (std::is_same_v<Def, ScenePathDef>) return def.paths[0];
  if constexpr (std::is_same_v<Def, ScenePathDef::Key>) return def.paths[0].keys[0];
  if constexpr (std::is_same_v<Def, SceneCharacterDef>) return def.characters[0];
  if constexpr (std::is_same_v<Def, PlacedSolidDef>) return def.props[0];
  if constexpr (std::is_same_v<Def, GroundDef>) return *def.ground;
  if constexpr (std::is_same_v<Def, ViewDef>) return def.view;
  if constexpr (std::is_same_v<Def, SceneSimulationDef>) return def.simulation;
}

CharacterDef characterOf(const json& document) {
  CharacterDef def = readCharacterText(document.dump()).def;
  def.rig.emplace();  // without a mesh it changes nothing but what is checked
  def.skin->mesh.parts.emplace_back();
  return def;
}

SceneDef sceneOf(const json& document) {
  SceneDef def = readSceneText(document.dump()).def;
  static const auto doll = std::make_shared<const Character>(readCharacterText(sample::kArm).def);
  def.characters[0].character = doll;
  return def;
}

template <class Run>
Found faultsOf(const Run& run) {
  Found found;
  try {
    run();
  } catch (const Error& error) {
    for (const Issue& issue : error.issues()) found[issue.where.pointer] = issue.message;
  }
  return found;
}

void build(const CharacterDef& def) {
  const Character built(def);
}
void build(const SceneDef& def) {
  const Stage built(def);
}
void read(const std::string& text, const CharacterDef*) {
  readCharacterText(text);
}
void read(const std::string& text, const SceneDef*) {
  readSceneText(text);
}

// The document's text with `value` where it has kHere.
constexpr const char* kHere = "<here>";
std::string textWith(const json& document, const std::string& value) {
  std::string text = document.dump();
  const std::string place = '"' + std::string(kHere) + '"';
  return text.replace(text.find(place), place.size(), value);
}

// Sets entry 1 of a vector, or the number itself; in the file's unit.
template <class M>
void set(M& member, double value, bool angle) {
  if constexpr (std::is_same_v<M, double>) {
    member = angle ? radians(value) : value;
  } else if constexpr (std::is_same_v<M, int>) {
    member = static_cast<int>(value);
  } else if constexpr (requires { member.has_value(); }) {
    if constexpr (std::is_same_v<typename M::value_type, double>)
      if (!member) member = 0;
    ASSERT_TRUE(member);
    set(*member, value, angle);
  } else {
    set(member[1], value, angle);
  }
}
template <class M>
constexpr bool isVector() {
  if constexpr (requires(M m) { m.has_value(); }) return isVector<typename M::value_type>();
  return requires(M m) {
    m[1];
  };
}

// One table's rows against reader and builder of the whole.
template <class Whole>
class Checker {
 public:
  Checker(json document, Whole whole) : document_(std::move(document)), whole_(std::move(whole)) {}

  template <class Def>
  void operator()(std::type_identity<Def>, const std::string& place) const {
    forEachTunable<Def>([&](const auto& row) {
      const std::string pointer = firstOf(place) + '/' + std::string(row.key);
      SCOPED_TRACE(pointer);
      if constexpr (requires { row.words; }) {
        for (const std::string_view word : row.words()) word_<Def>(row, pointer, word, true);
        word_<Def>(row, pointer, "surprise", false);
      } else {
        using M = std::remove_cvref_t<decltype(std::declval<Def>().*row.member)>;
        if constexpr (!std::is_same_v<M, bool>) ends<Def, M>(row, pointer);
      }
      ++*rows_;
    });
  }

  int rows() const { return *rows_; }

 private:
  template <class Def, class M>
  void ends(const auto& row, const std::string& pointer) const {
    const NumberRange& range = row.range;
    const double wide = range.max - range.min;
    const double least = range.aboveMin ? range.min + 1e-9 * wide : range.min;
    for (const double inside : {least, range.max}) number<Def, M>(row, pointer, inside, true);
    const double below = range.aboveMin ? range.min : range.min - 0.25 * wide;
    for (const double outside : {below, range.max + 0.25 * wide})
      number<Def, M>(row, pointer, outside, false);
  }

  template <class Def, class M>
  void number(const auto& row, const std::string& pointer, double value, bool good) const {
    json document = document_;
    json& at = document[json::json_pointer(pointer)];
    (isVector<M>() ? at[1] : at) = kHere;
    Whole whole = whole_;
    set(objectIn<Def>(whole).*row.member, value, row.isAngle());
    const std::string where = isVector<M>() ? pointer + "/1" : pointer;
    expectSame(document, whole, where, good, shortestText(value));
  }

  template <class Def>
  void word_(const auto& row, const std::string& pointer, std::string_view word, bool good) const {
    json document = document_;
    document[json::json_pointer(pointer)] = kHere;
    Whole whole = whole_;
    objectIn<Def>(whole).*row.member = word;
    expectSame(document, whole, pointer, good, '"' + std::string(word) + '"');
  }

  void expectSame(const json& document, const Whole& whole, const std::string& pointer, bool good,
                  const std::string& value) const {
    const std::string text = textWith(document, value);
    Found reader = faultsOf([&] { read(text, static_cast<const Whole*>(nullptr)); });
    Found builder = faultsOf([&] { build(whole); });
    const std::string said = reader[pointer];
    EXPECT_EQ(said.empty(), good) << value << ": the reader says \"" << said << '"';
    // What it says of a good value is not about its range: a scheme may not know contact.
    const bool ofRange = builder[pointer].find(", expected ") != std::string::npos;
    EXPECT_EQ(ofRange ? builder[pointer] : "", said) << value;
  }

  json document_;
  Whole whole_;
  std::shared_ptr<int> rows_ = std::make_shared<int>(0);
};

json withRigAndParts(json document) {
  document["rig"] = {{"file", "a.glb"}};
  document["skin"]["parts"] = {{{"name", "eyes"}}};
  return document;
}

TEST(Tunables, SamplesCanBeBuilt) {
  EXPECT_EQ(faultsOf([] { build(characterOf(kTunedCharacter)); }), Found());
  EXPECT_EQ(faultsOf([] { build(sceneOf(kTunedScene)); }), Found());
}

TEST(Tunables, ReaderAndBuilderTakeBothEndsOfARangeAndRefuseWhatIsBeyondInTheSameWords) {
  const Checker<CharacterDef> character(withRigAndParts(kTunedCharacter),
                                        characterOf(kTunedCharacter));
  forEachCharacterTable(character);
  EXPECT_GT(character.rows(), 60);
  const Checker<SceneDef> scene(kTunedScene, sceneOf(kTunedScene));
  forEachSceneTable(scene);
  EXPECT_GT(scene.rows(), 35);
}

// The schema of what stands at a place: through objects, lists and alternatives.
const json* schemaAt(const json& schema, const std::string& place) {
  const json* at = &schema;
  std::istringstream parts(place.substr(1));
  for (std::string part; std::getline(parts, part, '/');) {
    const json* next = nullptr;
    std::vector<const json*> open{at};
    for (std::size_t i = 0; i < open.size() && !next; ++i) {
      if (open[i]->contains("anyOf"))
        for (const json& one : (*open[i])["anyOf"]) open.push_back(&one);
      if (part == "*" && open[i]->contains("items")) next = &(*open[i])["items"];
      if (part != "*" && open[i]->contains("properties") && (*open[i])["properties"].contains(part))
        next = &(*open[i])["properties"][part];
    }
    if (!next) return nullptr;
    at = next;
  }
  return at;
}

TEST(Tunables, SchemaSaysTheirRangesHelpAndDefaults) {
  const auto check = [](const json& schema) {
    return [&schema]<class Def>(std::type_identity<Def>, const std::string& place) {
      forEachTunable<Def>([&](const auto& row) {
        const std::string at = place + '/' + std::string(row.key);
        const json* found = schemaAt(schema, at);
        ASSERT_TRUE(found) << at;
        EXPECT_EQ(found->value("description", ""), row.help) << at;
        if constexpr (!requires { row.words; }) {
          const json& number = found->contains("items") ? (*found)["items"] : *found;
          if (number.value("type", "") == "boolean") return;
          EXPECT_EQ(number.value("maximum", -1e300), row.range.max) << at;
          EXPECT_EQ(number.value(row.range.aboveMin ? "exclusiveMinimum" : "minimum", -1e300),
                    row.range.min)
              << at;
        }
      });
    };
  };
  const json character = json::parse(characterSchema()), scene = json::parse(sceneSchema());
  forEachCharacterTable(check(character));
  forEachSceneTable(check(scene));
  EXPECT_EQ((*schemaAt(character, "/skin/material/prestretch"))["default"], 1.08);
}

TEST(Tunables, DefaultsAreWithinTheirRanges) {
  const auto check = []<class Def>(std::type_identity<Def>, const std::string& place) {
    Diagnostics diagnostics;
    validateTunables(Def{}, place, diagnostics);
    EXPECT_TRUE(diagnostics.ok()) << place;
  };
  forEachCharacterTable(check);
  forEachSceneTable(check);
}

TEST(Tunables, UnitsAreThoseOfTheirNames) {
  const std::pair<const char*, const char*> kUnits[] = {{"_kg_per_m2", "kg/m²"},
                                                        {"_kg_per_m3", "kg/m³"},
                                                        {"_N_per_m", "N/m"},
                                                        {"_N_per_m3", "N/m³"},
                                                        {"_Nm", "N m"},
                                                        {"_Ns_per_m3", "N s/m³"},
                                                        {"_Ns_per_m", "N s/m"},
                                                        {"_per_s", "1/s"},
                                                        {"_m_per_s", "m/s"},
                                                        {"_m_per_s2", "m/s²"},
                                                        {"_deg_per_s", "deg/s"},
                                                        {"_s_per_J", "s/J"},
                                                        {"_deg", "deg"},
                                                        {"_Pa", "Pa"},
                                                        {"_hz", "Hz"},
                                                        {"_m", "m"},
                                                        {"_s", "s"}};
  const auto check = [&]<class Def>(std::type_identity<Def>, const std::string& place) {
    forEachTunable<Def>([&](const auto& row) {
      std::string_view suffix, unit;
      for (const auto& [ending, of] : kUnits)
        if (row.key.ends_with(ending) && std::string_view(ending).size() > suffix.size())
          suffix = ending, unit = of;
      EXPECT_EQ(row.unit, unit) << place << '/' << row.key;
      EXPECT_FALSE(row.help.empty()) << place << '/' << row.key;
    });
  };
  forEachCharacterTable(check);
  forEachSceneTable(check);
}

TEST(Tunables, PublishedPageIsTheOneThatTheTablesMake) {
  const std::string path = std::string(FASCIA_SOURCE_DIR) + "/docs/tunables.md";
  if (std::getenv("FASCIA_UPDATE_SCHEMA")) writeFileWhole(path, tunablesPage());
  EXPECT_EQ(readFile(path, 1 << 20), tunablesPage())
      << "run this test once with FASCIA_UPDATE_SCHEMA=1 to write it anew";
}

}  // namespace
}  // namespace fascia
