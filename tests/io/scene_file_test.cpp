#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include <nlohmann/json.hpp>

#include <fascia/io/documents/character_file.h>
#include <fascia/io/file/file.h>

#include "sample.h"
#include "scene_sample.h"
#include "support/replaced.h"

namespace fascia {
namespace {

using test::replaced;
using OrderedJson = nlohmann::ordered_json;
using testing::HasSubstr;
using testing::IsEmpty;

// Runs something that reads; what it finds wrong.
template <class Read>
std::vector<Issue> issuesOf(const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    return error.issues();
  }
  return {};
}

std::vector<Issue> sceneFaults(const std::string& text) {
  return issuesOf([&] { readSceneText(text, "x.fascia.json"); });
}

int lineOf(const std::string& text, const std::string& part) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(text.find(part));
  return 1 + static_cast<int>(std::count(text.begin(), end, '\n'));
}

TEST(SceneFile, FullTextComesBackUnchanged) {
  EXPECT_EQ(sceneText(readSceneText(sample::kFullScene).def), sample::kFullScene);
}

TEST(SceneFile, FullTextIsUnderstood) {
  using Form = SceneBodyDef::Form;
  const SceneDef def = readSceneText(sample::kFullScene).def;
  ASSERT_EQ(def.bodies.size(), 3u);
  const SceneBodyDef& block = def.bodies[0];
  EXPECT_EQ(block.form, Form::solid);
  EXPECT_EQ(block.solid.shape, "superellipsoid");
  EXPECT_EQ(block.solid.parameters.front(), 0.3);
  EXPECT_DOUBLE_EQ(block.orientation_rad.z(), radians(33.3));
  EXPECT_DOUBLE_EQ(block.spin_rad_per_s.y(), radians(120.7));
  EXPECT_DOUBLE_EQ(block.scatter.orientation_rad.z(), radians(45));
  EXPECT_EQ(block.points[1].name, "end");  // in the order of the file
  EXPECT_EQ(block.ornaments[0].position_m, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(def.bodies[1].form, Form::outline);
  EXPECT_EQ(def.bodies[1].outline_m[2], Vec2(0.5, 0.75));
  EXPECT_EQ(def.bodies[1].basis.cells, Eigen::Vector3i(2, 1, 1));
  EXPECT_EQ(def.bodies[2].form, Form::mesh);
  EXPECT_EQ(def.bodies[2].mesh_file, "meshes/duck.glb");
  EXPECT_EQ(def.bodies[2].mesh, nullptr);  // only files on disk have others beside them
  EXPECT_EQ(def.constraints[0].kind, SceneConstraintDef::Kind::spring);
  EXPECT_FALSE(def.paths[0].keys[0].velocity_m_per_s.has_value());
  EXPECT_EQ(def.paths[0].keys[1].leaving_m_per_s, Vec3(0, 1, 0));
  EXPECT_DOUBLE_EQ(def.characters[0].heading_rad, radians(12.345));
  EXPECT_EQ(def.props[0].friction, 0.9);
  EXPECT_EQ(def.ground->height_m, -0.5);
  EXPECT_EQ(def.simulation.scheme, "energy");
}

// Every key that the published schema knows, but for the numbers of other shapes.
TEST(SceneFile, TheSampleHasEveryKey) {
  std::set<std::string> inSample;
  const std::function<void(const OrderedJson&)> visit = [&](const OrderedJson& value) {
    for (const auto& [key, child] : value.items()) {
      if (value.is_object()) inSample.insert(key);
      if (child.is_structured()) visit(child);
    }
  };
  visit(OrderedJson::parse(sample::kFullScene));
  int keys = 0;
  const std::function<void(const OrderedJson&)> check = [&](const OrderedJson& schema) {
    if (schema.contains("items")) check(schema["items"]);
    if (!schema.contains("properties")) return;
    for (const auto& [key, child] : schema["properties"].items()) {
      const bool ofShape = child.value("description", "").find("; normally ") != std::string::npos;
      if (key == "$schema" || ofShape) continue;
      EXPECT_TRUE(inSample.contains(key)) << key;
      ++keys;
      if (key != "deformations") check(child);
    }
  };
  check(OrderedJson::parse(sceneSchema()));
  EXPECT_GT(keys, 70);
}

TEST(SceneFile, DefaultsAreLeftOut) {
  const SceneDef def = readSceneText(sample::kSmallScene).def;
  EXPECT_EQ(def.dimension, 3);
  EXPECT_FALSE(def.ground.has_value());
  EXPECT_EQ(OrderedJson::parse(sceneText(def)), OrderedJson::parse(sample::kSmallScene));
  const std::string spelled = replaced(
      sample::kSmallScene, "0.2}",
      R"(0.2, "collides": true, "friction": 0.5, "basis": "affine", "position_m": [0, 0]})");
  EXPECT_EQ(sceneText(readSceneText(spelled).def), sceneText(def));
}

TEST(SceneFile, NumbersComeBackToTheBit) {
  SceneDef def = readSceneText(sample::kFullScene).def;
  for (int i = 1; i <= 200; ++i) {
    def.bodies[0].orientation_rad = Vec3(std::sin(i), std::cos(i), std::tan(i));
    def.bodies[0].position_m = Vec3(std::ldexp(std::sin(3 * i), -i % 40), std::sqrt(i), 1.0 / i);
    def.characters[0].heading_rad = std::sin(7 * i);
    def.bodies[1].outline_m[0] = Vec2(std::sin(5 * i), 1.0 / (3 * i));
    const SceneDef back = readSceneText(sceneText(def)).def;
    ASSERT_EQ(back.bodies[0].orientation_rad, def.bodies[0].orientation_rad);
    ASSERT_EQ(back.bodies[0].position_m, def.bodies[0].position_m);
    ASSERT_EQ(back.characters[0].heading_rad, def.characters[0].heading_rad);
    ASSERT_EQ(back.bodies[1].outline_m, def.bodies[1].outline_m);
  }
}

TEST(SceneFile, WritingRefusesNaN) {
  SceneDef def = readSceneText(sample::kSmallScene).def;
  def.bodies[0].position_m.x() = std::nan("");
  EXPECT_THROW(sceneText(def), Error);
}

// One letter too many in the first key of every object.
TEST(SceneFile, UnknownKeysAreNamedWithTheNearestAtEveryLevel) {
  const OrderedJson sample = OrderedJson::parse(sample::kFullScene);
  int objects = 0;
  const std::function<void(const OrderedJson&, const std::string&)> visit =
      [&](const OrderedJson& value, const std::string& pointer) {
        const bool names = pointer.ends_with("/places") ||
                           (pointer.ends_with("/points") && value.is_object()) ||
                           pointer.ends_with("/basis");
        if (value.is_object() && !names && !pointer.empty()) {
          OrderedJson broken = sample;
          const std::string key = value.items().begin().key(), wrong = key + "z";
          broken[OrderedJson::json_pointer(pointer)][wrong] = 1;
          const std::vector<Issue> found = sceneFaults(broken.dump());
          ASSERT_EQ(found.size(), 1u) << pointer;
          EXPECT_EQ(found[0].where.pointer, pointer + "/" + wrong);
          EXPECT_THAT(found[0].hint, HasSubstr(key)) << pointer;
          ++objects;
        }
        for (const auto& [key, child] : value.items())
          if (child.is_structured()) visit(child, pointer + "/" + key);
      };
  visit(sample, "");
  EXPECT_GT(objects, 15);
  const std::vector<Issue> top =
      sceneFaults(replaced(sample::kFullScene, "\"constraints\"", "\"constrains\""));
  ASSERT_EQ(top.size(), 1u);
  EXPECT_EQ(top[0].where.pointer, "/constrains");
  EXPECT_THAT(top[0].hint, HasSubstr("constraints"));
}

TEST(SceneFile, ABodyIsMadeOfOneThing) {
  const std::string outline = R"("outline_m": [[0, 0], [1, 0], [0, 1]])",
                    mesh = R"("mesh": "a.glb")";
  const std::string shape = R"("shape": "sphere")";
  for (const auto& [first, second] : {std::pair(outline, mesh), {mesh, shape}, {shape, outline}}) {
    const std::string text = replaced(
        sample::kSmallScene, "\"shape\": \"sphere\", \"radius_m\": 0.2", first + ", " + second);
    const std::vector<Issue> found = sceneFaults(text);
    ASSERT_EQ(found.size(), 1u) << text;
    EXPECT_EQ(found[0].where.pointer, "/bodies/0");
    EXPECT_EQ(found[0].where.line, 5);
    EXPECT_THAT(found[0].text(), HasSubstr("several of"));
  }
}

TEST(SceneFile, EveryFaultSaysWhereItIs) {
  struct Bad {
    const char *from, *to, *pointer, *message;
  };
  const Bad inputs[] = {
      {"\"dimension\": 2", "\"dimension\": 4", "/dimension", "expected"},
      {"\"name\": \"block\"", "\"name\": 3", "/bodies/0/name", "expected a text"},
      {"\"half_x_m\": 0.3", "\"half_x_m\": -1", "/bodies/0/half_x_m", "expected"},
      {"[0, 1.5, 0.25]", "[0]", "/bodies/0/position_m", "2 or 3 numbers"},
      {"[0, 1.5, 0.25]", "[0, 1e300]", "/bodies/0/position_m/1", "found 1e300"},
      {"\"quadratic\"", "\"cubic\"", "/bodies/0/basis", "quadratic"},
      {"\"density_kg_per_m3\": 500", "\"density_kg_per_m3\": 0", "/bodies/0/density_kg_per_m3",
       "expected"},
      {"\"friction\": 0.25", "\"friction\": 11", "/bodies/0/friction", "[0, 10]"},
      {"\"collides\": false", "\"collides\": 0", "/bodies/0/collides", "expected"},
      {"\"top\": [0, 0.2, 0]", "\"top\": \"up\"", "/bodies/0/points/top", "2 or 3 numbers"},
      {"[0.5, 0, 0]", "[0.5, 0, 0, 0]", "/bodies/0/scatter/position_m", "2 or 3 numbers"},
      {"\"#101010\"", "\"#10101\"", "/bodies/0/ornaments/0/color", "colour"},
      {"[0.5, 0.75]", "[0.5, 0.75, 1]", "/bodies/1/outline_m/2", "2 numbers"},
      {"\"thickness_m\": 0.1", "\"thickness_m\": 0", "/bodies/1/thickness_m", "expected"},
      {"\"mesh\": \"meshes/duck.glb\"", "\"mesh\": 7", "/bodies/2/mesh", "expected a text"},
      {"\"hook\": [0, 3, 0]", "\"hook\": 3", "/places/hook", "2 or 3 numbers"},
      {"\"type\": \"spring\"", "\"type\": \"sprig\"", "/constraints/0/type", "sprig"},
      {"[\"block.top\", \"hook\"]", "[\"a\", \"b\", \"c\"]", "/constraints/0/points", "2"},
      {"\"time_s\": 2", "\"time_s\": -2", "/paths/0/keys/1/time_s", "expected"},
      {"\"heading_deg\": 12.345", "\"heading_deg\": \"east\"", "/characters/0/heading_deg",
       "expected"},
      {"\"radius_m\": 0.4", "\"radius_m\": -4", "/props/0/radius_m", "expected"},
      {"\"height_m\": -0.5", "\"height_m\": null", "/ground/height_m", "expected"},
      {"\"camera\": \"side\"", "\"camera\": [1]", "/view/camera", "expected a text"},
      {"\"script\": \"act.lua\"", "\"script\": {}", "/script", "expected a text"},
      {"\"scheme\": \"energy\"", "\"scheme\": \"energi\"", "/simulation/scheme", "energi"},
      {"\"step_s\": 0.005", "\"step_s\": 1", "/simulation/step_s", "expected"},
  };
  for (const Bad& input : inputs) {
    const std::string text = replaced(sample::kFullScene, input.from, input.to);
    const std::vector<Issue> found = sceneFaults(text);
    ASSERT_FALSE(found.empty()) << input.pointer;
    EXPECT_EQ(found[0].where.file, "x.fascia.json") << input.pointer;
    EXPECT_EQ(found[0].where.line, lineOf(text, input.to)) << input.pointer;
    EXPECT_EQ(found[0].where.pointer, input.pointer);
    EXPECT_THAT(found[0].text(), HasSubstr(input.message)) << input.pointer;
  }
}

TEST(SceneFile, MissingKeysAndRepeatedOnesAreFaults) {
  const std::pair<const char*, const char*> edits[] = {
      {"\"name\": \"block\",", "/bodies/0"},
      {"\"type\": \"spring\",", "/constraints/0"},
      {"\"point\": \"block.end\",", "/paths/0"},
      {"\"time_s\": 2,", "/paths/0/keys/1"},
      {"\"file\": \"doll.fascia.json\",", "/characters/0"},
      {"\"name\": \"table\",", "/props/0"}};
  for (const auto& [part, pointer] : edits) {
    const std::vector<Issue> found = sceneFaults(replaced(sample::kFullScene, part, ""));
    ASSERT_EQ(found.size(), 1u) << part;
    EXPECT_EQ(found[0].where.pointer, pointer);
    EXPECT_THAT(found[0].message, HasSubstr("missing"));
    const std::string twice = std::string(part) + " " + part;
    const std::vector<Issue> repeated = sceneFaults(replaced(sample::kFullScene, part, twice));
    ASSERT_EQ(repeated.size(), 1u) << part;
    EXPECT_THAT(repeated[0].message, HasSubstr("twice"));
  }
}

TEST(SceneFile, KindsAreNotMixedUp) {
  const std::vector<Issue> character = sceneFaults(sample::kMinimal);
  ASSERT_EQ(character.size(), 1u);
  EXPECT_THAT(character[0].text(), HasSubstr("\"kind\": \"scene\""));
  const std::vector<Issue> named =
      sceneFaults(replaced(sample::kSmallScene, "\"scene\"", "\"character\""));
  ASSERT_EQ(named.size(), 1u);
  EXPECT_EQ(named[0].where.pointer, "/kind");
  const std::vector<Issue> scene = sample::faults(sample::kFullScene);
  ASSERT_EQ(scene.size(), 1u);
  EXPECT_EQ(scene[0].where.pointer, "/kind");
  EXPECT_EQ(scene[0].where.line, 3);
}

// A scene on disk with all that can lie beside one.
class SceneFolder : public testing::Test {
 protected:
  static constexpr const char* kText = R"({
  "fascia": 1,
  "kind": "scene",
  "name": "stage",
  "bodies": [
    {"name": "box",
     "mesh": "meshes/box.glb"}],
  "characters": [
    {"name": "doll",
     "file": "doll.fascia.json"}],
  "script": "act.lua"
}
)";

  SceneFolder() {
    std::filesystem::create_directories(folder_ / "scene/meshes");
    writeFileWhole(folder_ / "scene/meshes/box.glb",
                   sample::glbOf(sample::boxMesh({0.2, 0.3, 0.4})));
    writeFileWhole(folder_ / "scene/doll.fascia.json", kDoll);
    writeFileWhole(folder_ / "scene/act.lua", "wait(1)\n");
    for (const char* name : {"meshes/box.glb", "doll.fascia.json", "act.lua"}) {
      const std::string outside = std::filesystem::path(name).filename().string();
      std::filesystem::copy_file(folder_ / "scene/" + name, folder_ / outside);
    }
  }

  std::string path() const { return folder_ / "scene/stage.fascia.json"; }
  std::vector<Issue> faults(const std::string& text) const {
    writeFileWhole(path(), text);
    return issuesOf([&] { loadStage(path()); });
  }

  static constexpr const char* kDoll = R"({
  "fascia": 1,
  "name": "doll",
  "skeleton": [{"name": "root"}],
  "solids": [{"name": "belly", "joint": "root", "radius_m": 0.2}]
}
)";
  // Names what lies beside the scene, and where that stands in kText.
  struct Beside {
    const char *name, *pointer;
    int line;
  };
  static constexpr Beside kBeside[] = {{"meshes/box.glb", "/bodies/0/mesh", 7},
                                       {"doll.fascia.json", "/characters/0/file", 10},
                                       {"act.lua", "/script", 11}};
  sample::Folder folder_;
};

TEST_F(SceneFolder, ReadsAllThatItNames) {
  writeFileWhole(path(), kText);
  const Stage stage = loadStage(path());
  EXPECT_EQ(stage.def().script_text, "wait(1)\n");
  EXPECT_EQ(stage.def().characters[0].character->def().name, "doll");
  EXPECT_EQ(stage.def().bodies[0].mesh->triangles.size(), 12u);
  const double volume_m3 = 0.4 * 0.6 * 0.8, density = stage.def().bodies[0].density_kg_per_m3;
  EXPECT_NEAR(stage.bodies().shape(BodyId(0)).mass_kg(), density * volume_m3,
              1e-6 * density * volume_m3);
  EXPECT_EQ(stage.def().folder, folder_ / "scene");
  EXPECT_TRUE(isSceneFile(path()));
  EXPECT_FALSE(isSceneFile(folder_ / "scene/doll.fascia.json"));
}

TEST_F(SceneFolder, NothingOutsideOfTheFolderIsRead) {
  for (const Beside& file : kBeside) {
    const std::string plain = std::filesystem::path(file.name).filename().string();
    const std::string link = "link-" + plain;
    std::filesystem::create_symlink("../" + plain, folder_ / "scene/" + link);
    for (const std::string& name : {std::string("../") + plain,
                                    std::string("meshes/../../") + plain, folder_ / plain, link}) {
      const std::vector<Issue> found = faults(replaced(kText, file.name, name));
      ASSERT_EQ(found.size(), 1u) << name;
      EXPECT_EQ(found[0].where.file, path());
      EXPECT_EQ(found[0].where.line, file.line) << name;
      EXPECT_EQ(found[0].where.pointer, file.pointer) << name;
      EXPECT_THAT(found[0].message, HasSubstr("folder")) << name;
    }
  }
}

TEST_F(SceneFolder, LinksThatStayInsideAreFollowed) {
  std::filesystem::create_symlink("act.lua", folder_ / "scene/link.lua");
  EXPECT_THAT(faults(replaced(kText, "act.lua", "link.lua")), IsEmpty());
}

TEST_F(SceneFolder, EverythingThatIsMissingIsToldAtOnce) {
  for (const Beside& file : kBeside) std::filesystem::remove(folder_ / "scene/" + file.name);
  const std::vector<Issue> found = faults(kText);
  ASSERT_EQ(found.size(), 3u);
  for (const Beside& file : kBeside) {
    const auto issue = std::find_if(found.begin(), found.end(), [&](const Issue& i) {
      return i.where.pointer == file.pointer;
    });
    ASSERT_NE(issue, found.end()) << file.pointer;
    EXPECT_EQ(issue->where.line, file.line);
    EXPECT_THAT(issue->message, HasSubstr("is missing"));
    EXPECT_THAT(issue->message, HasSubstr(file.name));
  }
}

TEST_F(SceneFolder, FaultsInsideOfACharacterAreToldWithBothPlaces) {
  writeFileWhole(folder_ / "scene/doll.fascia.json",
                 replaced(replaced(kDoll, "0.2", "-2"), "\"joint\"", "\"join\""));
  const std::vector<Issue> found = faults(kText);
  ASSERT_EQ(found.size(), 3u);  // the radius, the unknown key, the missing one
  for (const Issue& issue : found) {
    EXPECT_EQ(issue.where.file, path());
    EXPECT_EQ(issue.where.line, 10);
    EXPECT_EQ(issue.where.pointer, "/characters/0/file");
    EXPECT_THAT(issue.message, HasSubstr("doll.fascia.json:5: /solids/0"));
  }
}

TEST_F(SceneFolder, ACharacterThatIsASceneAndAMeshThatIsNoneAreRefused) {
  writeFileWhole(folder_ / "scene/doll.fascia.json", sample::kSmallScene);
  writeFileWhole(folder_ / "scene/meshes/box.glb", "glTF");
  const std::vector<Issue> found = faults(kText);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_THAT(found[0].text(), HasSubstr("doll.fascia.json:3: /kind"));
  EXPECT_EQ(found[1].where.line, 7);
  EXPECT_THAT(found[1].message, HasSubstr("box.glb"));
}

TEST_F(SceneFolder, OpenMeshesAreRefusedWhereTheyAreNamed) {
  TriangleMesh open = sample::boxMesh({1, 1, 1});
  open.triangles.pop_back();
  writeFileWhole(folder_ / "scene/meshes/box.glb", sample::glbOf(open));
  const std::vector<Issue> found = faults(kText);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].where.file, path());
  EXPECT_GE(found[0].where.line, 6);
  EXPECT_LE(found[0].where.line, 7);
}

TEST_F(SceneFolder, FaultsFoundWhileBuildingHaveALine) {
  const std::string text = replaced(kText, "  \"script\"", R"(  "constraints": [
    {"type": "nail",
     "points": ["box.tip"]}],
  "script")");
  const std::vector<Issue> found = faults(text);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].where.file, path());
  EXPECT_EQ(found[0].where.line, 13);
  EXPECT_EQ(found[0].where.pointer, "/constraints/0/points/0");
}

TEST_F(SceneFolder, FileComesBackFromDisk) {
  writeFileWhole(path(), kText);
  const std::string copy = folder_ / "scene/copy.fascia.json";
  const SceneFile file = readSceneFile(path());
  writeSceneFile(file.def, copy);
  const SceneFile back = readSceneFile(copy);
  EXPECT_EQ(sceneText(back.def), sceneText(file.def));
  EXPECT_EQ(back.def.bodies[0].mesh->positions, file.def.bodies[0].mesh->positions);
  EXPECT_EQ(back.def.script_text, file.def.script_text);
}

}  // namespace
}  // namespace fascia
