#include <fascia/io/documents/plain_codecs.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include <fascia/io/file/file.h>

#include "sample.h"
#include "support/replaced.h"

namespace fascia {
namespace {

using sample::faults;
using test::replaced;
using testing::HasSubstr;

struct BadInput {
  const char* name;
  std::string from, to;  // an edit of the full sample
  const char* pointer;
  const char* message;
};

TEST(CharacterFile, MinimalCharacterTakesDefaults) {
  const CharacterDef def = readCharacterText(sample::kMinimal).def;
  EXPECT_EQ(def.name, "ball");
  ASSERT_EQ(def.flesh.solids.size(), 1u);
  EXPECT_EQ(def.flesh.solids[0].solid.parameters, std::vector<double>{0.2});
  ASSERT_TRUE(def.skin.has_value());
  EXPECT_EQ(def.skin->material.density_kg_per_m2, SkinMaterialDef{}.density_kg_per_m2);
}

TEST(CharacterFile, FullTextComesBackUnchanged) {
  EXPECT_EQ(characterText(readCharacterText(sample::kFull).def), sample::kFull);
}

TEST(CharacterFile, RigTakesThePlaceOfTheGrid) {
  const CharacterDef def = readCharacterText(sample::kRigged).def;
  ASSERT_TRUE(def.rig && def.skin);
  EXPECT_EQ(def.rig->file, "meshes/fox.glb");
  EXPECT_EQ(def.rig->scale, 0.01);
  EXPECT_EQ(def.rig->model, nullptr);  // only files on disk have others beside them
  EXPECT_EQ(def.skin->material.drag_Ns_per_m3, 2);
  EXPECT_EQ(def.skin->fat.bulk_Pa, 900);
  EXPECT_TRUE(def.skin->contact.self);
  ASSERT_EQ(def.skin->mesh.parts.size(), 2u);
  EXPECT_TRUE(def.skin->mesh.parts[0].rigid);
  EXPECT_FALSE(def.skin->mesh.parts[1].rigid);
  EXPECT_EQ(characterText(def), sample::kRigged);
}

TEST(CharacterFile, SkinNeedsEndsOrARig) {
  const auto bare = faults(replaced(sample::kRigged, "\"rig\"", "\"rag\""));
  ASSERT_EQ(bare.size(), 4u);
  EXPECT_EQ(bare[0].where.pointer, "/rag");
  EXPECT_EQ(bare[1].where.pointer, "/skin");
  EXPECT_EQ(bare[1].where.line, 7);
  EXPECT_THAT(bare[1].text(), HasSubstr("\"bottom\" is missing"));
  EXPECT_THAT(bare[2].text(), HasSubstr("\"top\" is missing"));
  EXPECT_EQ(bare[3].where.pointer, "/skin/parts");
  const auto both =
      faults(replaced(sample::kRigged, "\"material\"", "\"grid\": [16, 8], \"material\""));
  ASSERT_EQ(both.size(), 1u);
  EXPECT_EQ(both[0].where.pointer, "/skin/grid");
  EXPECT_THAT(both[0].message, HasSubstr("does not go with \"rig\""));
}

TEST(CharacterFile, FullTextIsUnderstood) {
  const CharacterDef def = readCharacterText(sample::kFull).def;
  EXPECT_DOUBLE_EQ(def.skeleton.joints[1].dofs[0].max, radians(120.7));
  EXPECT_EQ(def.skeleton.joints[1].dofs[1].rest, 0.01);
  const FleshSolidDef& biceps = def.flesh.solids[0];
  EXPECT_DOUBLE_EQ(biceps.drivers[0].points[1].jointValue, radians(120));
  EXPECT_EQ(biceps.drivers[0].points[1].parameter, 0.08);
  EXPECT_EQ(biceps.color.r, 0xb8 / 255.0f);
  EXPECT_FALSE(biceps.soft);
  const SoftSolidDef& soft = def.flesh.solids[2].soft.value();
  EXPECT_EQ(soft.basis.cells, Eigen::Vector3i(2, 1, 1));
  EXPECT_EQ(soft.density_kg_per_m3, 900);
  EXPECT_EQ(soft.rigidity_Pa, SoftSolidDef().rigidity_Pa);
  EXPECT_EQ(soft.held_m[1], Vec3(0.02, 0.03, 0.01));
  EXPECT_EQ(def.skin->regions[0].u_min, 0.8);
  ASSERT_EQ(def.skin->points->fat.size(), 6u);
  EXPECT_EQ(def.skin->points->fat[2], 0.012f);
  EXPECT_EQ(def.skin->points->anchor_solid.values(), (std::vector<int>{0, 0, 0, 0, -1, -1}));
  const MotionDef& flex = def.motions[0];
  EXPECT_DOUBLE_EQ(flex.tracks[0].keys[2].value, radians(-10));
  EXPECT_EQ(flex.tracks[0].keys[2].tension, 0.5);
  EXPECT_EQ(flex.tracks[3].channel, "twist.angle_rad");
}

TEST(CharacterFile, AnyNumbersComeBackToTheBit) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-3, 3);
  CharacterDef def = readCharacterText(sample::kFull).def;
  for (int round = 0; round < 300; ++round) {
    JointDef& joint = def.skeleton.joints[1];
    joint.orientation_rad = Vec3(uniform(random), uniform(random), uniform(random));
    joint.offset_m.x() = std::ldexp(uniform(random), static_cast<int>(random() % 80) - 60);
    joint.dofs[0].rest = uniform(random);
    def.motions[0].tracks[0].keys[1].value = uniform(random);
    def.skin->points->fat.edit()[1] = std::abs(static_cast<float>(uniform(random))) / 3;
    def.skin->points->anchor.edit()[4][2] = -0.0f;
    const CharacterDef back = readCharacterText(characterText(def)).def;
    const JointDef& same = back.skeleton.joints[1];
    ASSERT_EQ(same.orientation_rad, joint.orientation_rad);
    ASSERT_EQ(same.offset_m, joint.offset_m);
    ASSERT_EQ(same.dofs[0].rest, joint.dofs[0].rest);
    ASSERT_EQ(back.motions[0].tracks[0].keys[1].value, def.motions[0].tracks[0].keys[1].value);
    ASSERT_EQ(back.skin->points->fat, def.skin->points->fat);
    ASSERT_TRUE(std::signbit(back.skin->points->anchor[4][2]));
  }
}

TEST(CharacterFile, DegreesStayAsTyped) {
  for (const char* digits : {"30", "120.7", "-0.1", "33.3", "1e-5", "359.999"}) {
    const double value = std::stod(degreesDigits(radiansFromDegrees(digits)));
    EXPECT_EQ(value, std::stod(digits)) << digits;
  }
}

TEST(CharacterFile, EveryBasisComesBack) {
  using Kind = BodyBasisDef::Kind;
  for (const auto& [basis, text] : std::vector<std::pair<BodyBasisDef, std::string>>{
           {{Kind::polynomial, 2, {1, 1, 1}}, "\"quadratic\""},
           {{Kind::polynomial, 3, {1, 1, 1}}, "{\"polynomial\": 3}"},
           {{Kind::lattice, 2, {3, 2, 1}}, "{\"lattice\": [3, 2, 1]}"}}) {
    CharacterDef def = readCharacterText(sample::kFull).def;
    def.flesh.solids[2].soft->basis = basis;
    EXPECT_THAT(characterText(def), HasSubstr("\"basis\": " + text));
    EXPECT_EQ(readCharacterText(characterText(def)).def.flesh.solids[2].soft->basis, basis);
  }
}

TEST(CharacterFile, WritingRefusesNaN) {
  CharacterDef def = readCharacterText(sample::kMinimal).def;
  def.skin->fat.thickness_m = std::nan("");
  EXPECT_THROW(characterText(def), Error);
}

TEST(CharacterFile, EveryFaultSaysWhereItIs) {
  const BadInput inputs[] = {
      {"unknown key", "\"radius_m\": 0.07", "\"radios_m\": 0.07", "/solids/1/radios_m",
       "unknown key"},
      {"wrong type", "\"name\": \"elbow\"", "\"name\": 3", "/skeleton/1/name", "expected a text"},
      {"zero size", "\"radius_m\": 0.07", "\"radius_m\": 0", "/solids/1/radius_m", "expected"},
      {"negative size", "\"radius_m\": 0.07", "\"radius_m\": -1", "/solids/1/radius_m", "expected"},
      {"huge number", "[0, 1.25, 0]", "[0, 1e300, 0]", "/skeleton/0/offset_m/1", "found 1e300"},
      {"too few", "[0, 1.25, 0]", "[0, 1.25]", "/skeleton/0/offset_m", "3 numbers"},
      {"grid", "[16, 8]", "[0, 8]", "/skin/grid/0", "whole number"},
      {"giant grid", "[16, 8]", "[4096, 4096]", "/skin/grid", "more than"},
      {"fraction", "[16, 8]", "[16.5, 8]", "/skin/grid/0", "whole number"},
      {"colour", "\"#b84a45\"", "\"#b84a4\"", "/solids/0/color", "colour"},
      {"shape", "\"shape\": \"sphere\", \"radius_m\": 0.07", "\"shape\": \"sfere\"",
       "/solids/1/shape", "sfere"},
      {"dof", "\"rz\": {}", "\"rw\": {}", "/skeleton/1/dofs/rw", "degree of freedom"},
      {"row count", "\"0.1*3\"", "\"0.1*4\"", "/skin/points/fat_m/1", "expected 3 entries"},
      {"row text", "\"0.1*3\"", "\"0.1 x\"", "/skin/points/fat_m/1", "expected entries"},
      {"row NaN", "\"0.1*3\"", "\"nan*3\"", "/skin/points/fat_m/1", "expected entries"},
      {"duplicate", "\"loop\": true", "\"loop\": true, \"loop\": true", "/motions/0/loop", "twice"},
      {"integrator", "\"verlet\"", "\"verle\"", "/simulation/integrator", "verle"},
      {"range", "\"frame_rate_hz\": 30", "\"frame_rate_hz\": 0", "/simulation/frame_rate_hz",
       "[1, 1000]"},
      {"key unit", "\"value_m\": 0.1", "\"value_deg\": 0.1", "/motions/0/tracks/1/keys/0/value_deg",
       "unknown key"},
      {"basis", "{\"lattice\": [2, 1, 1]}", "\"cubic\"", "/solids/2/soft/basis", "quadratic"},
      {"cells", "{\"lattice\": [2, 1, 1]}", "{\"lattice\": [2]}", "/solids/2/soft/basis/lattice",
       "two or three"},
      {"many cells", "{\"lattice\": [2, 1, 1]}", "{\"lattice\": [2, 7, 1]}",
       "/solids/2/soft/basis/lattice/1", "[1, 6]"},
      {"order", "{\"lattice\": [2, 1, 1]}", "{\"polynomial\": 1.5}",
       "/solids/2/soft/basis/polynomial", "whole number"},
      {"density", "\"density_kg_per_m3\": 900", "\"density_kg_per_m3\": 0",
       "/solids/2/soft/density_kg_per_m3", "(0, 1e6]"},
      {"held point", "[0.02, 0.03, 0.01]", "[0.02, 0.03]", "/solids/2/soft/held_m/1", "3 numbers"},
  };
  for (const BadInput& input : inputs) {
    const std::string text = replaced(sample::kFull, input.from, input.to);
    const int line =
        1 +
        static_cast<int>(std::count(
            text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find(input.to)), '\n'));
    const std::vector<Issue> found = faults(text);
    ASSERT_FALSE(found.empty()) << input.name;
    EXPECT_EQ(found[0].where.file, "x.fascia.json") << input.name;
    EXPECT_EQ(found[0].where.line, line) << input.name;
    EXPECT_EQ(found[0].where.pointer, input.pointer) << input.name;
    EXPECT_THAT(found[0].text(), HasSubstr(input.message)) << input.name;
  }
}

TEST(CharacterFile, NearestNameIsSuggested) {
  const auto found = faults(replaced(sample::kFull, "\"shear_N_per_m\"", "\"sheer_N_per_m\""));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].hint, HasSubstr("shear_N_per_m"));
}

TEST(CharacterFile, AllFaultsAreReportedAtOnce) {
  std::string text = replaced(sample::kFull, "\"radius_m\": 0.07", "\"radius_m\": -1");
  text = replaced(text, "\"loop\": true", "\"loop\": 1");
  text = replaced(text, "\"fat_m\"", "\"fad_m\"");
  EXPECT_EQ(faults(text).size(), 3u);
}

TEST(CharacterFile, BrokenJsonIsRefused) {
  const std::string minimal = sample::kMinimal;
  const std::string documents[] = {"",
                                   "{",
                                   "[]",
                                   "null",
                                   "3",
                                   minimal + "x",
                                   minimal + "{}",
                                   "{\"fascia\": NaN}",
                                   replaced(minimal, "0.2", "1e999"),
                                   replaced(minimal, "0.2", "NaN"),
                                   replaced(minimal, "ball", "b\xff\xfe"),
                                   replaced(minimal, "ball", "b\x01"),
                                   std::string(100'000, '['),
                                   "{\"a\":" + std::string(100'000, '['),
                                   replaced(minimal, "0.2", "0.2 // comment")};
  for (const std::string& document : documents) {
    EXPECT_FALSE(faults(document).empty()) << document.substr(0, 80);
  }
}

TEST(CharacterFile, DeepNestingIsNamed) {
  const auto found = faults("{\"fascia\": 1, \"skin\": " + std::string(1000, '['));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].message, HasSubstr("levels deep"));
}

TEST(CharacterFile, NewerFormatIsOneClearError) {
  const auto found = faults(R"({"fascia": 2, "novelty": true})");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].where.pointer, "/fascia");
  EXPECT_THAT(found[0].message, HasSubstr("format 2"));
}

TEST(CharacterFile, OtherKindsAreRefusedByName) {
  const auto found = faults(R"({"fascia": 1, "kind": "scene"})");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].where.pointer, "/kind");
}

TEST(CharacterFile, MissingFileAndFolderAreErrors) {
  const sample::Folder folder;
  EXPECT_THROW(readCharacterFile(folder / "none.fascia.json"), Error);
  EXPECT_THROW(readCharacterFile(folder.path()), Error);
}

TEST(CharacterFile, FileComesBackFromDisk) {
  const sample::Folder folder;
  const std::string path = folder / "arm.fascia.json";
  writeCharacterFile(readCharacterText(sample::kFull).def, path);
  EXPECT_EQ(folder.entryCount(), 1u);
  const CharacterFile file = readCharacterFile(path);
  EXPECT_EQ(file.def.folder, folder.path());
  EXPECT_EQ(characterText(file.def), sample::kFull);
}

TEST(CharacterFile, MissingTextureHasALine) {
  const sample::Folder folder;
  const std::string path = folder / "arm.fascia.json";
  writeFileWhole(path,
                 replaced(sample::kFull, "\"color\": \"#ffcc99\"", "\"texture\": \"no.png\""));
  try {
    readCharacterFile(path);
    FAIL() << "read without its texture";
  } catch (const Error& error) {
    const Issue& issue = error.issues().front();
    EXPECT_EQ(issue.where.file, path);
    EXPECT_EQ(issue.where.pointer, "/skin/texture");
    EXPECT_GT(issue.where.line, 40);
    EXPECT_THAT(issue.message, HasSubstr("missing"));
  }
}

TEST(CharacterFile, FaultsFoundWhileBuildingHaveALine) {
  const std::string cyclic = replaced(sample::kArm, "\"name\": \"shoulder\",",
                                      "\"name\": \"shoulder\", \"parent\": \"elbow\",");
  const std::string nowhere = replaced(sample::kArm, "\"joint\": \"elbow\", \"radius_m\": 0.2",
                                       "\"joint\": \"elbov\", \"radius_m\": 0.2");
  const std::pair<std::string, int> cases[] = {{cyclic, 5}, {nowhere, 10}};
  for (const auto& [text, line] : cases) {
    try {
      buildCharacter(readCharacterText(text, "x.fascia.json"));
      FAIL() << "built a character that cannot be";
    } catch (const Error& error) {
      EXPECT_EQ(error.issues().front().where.file, "x.fascia.json");
      EXPECT_EQ(error.issues().front().where.line, line) << error.what();
    }
  }
}

TEST(LineIndex, FindsPlacesAndTheirAncestors) {
  const LineIndex lines = readCharacterText(sample::kFull, "f").lines;
  EXPECT_EQ(lines.locate("/skeleton/1/parent").line, 9);
  const Location missing = lines.locate("/skeleton/0/parent");
  EXPECT_EQ(missing.line, 6);
  EXPECT_EQ(missing.pointer, "/skeleton/0/parent");
  EXPECT_EQ(lines.locate("/solids/0/orientation_rad").pointer, "/solids/0/orientation_deg");
  EXPECT_EQ(lines.locate("").line, 1);
}

}  // namespace
}  // namespace fascia
