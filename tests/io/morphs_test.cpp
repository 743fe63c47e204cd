// Morph targets of glTF files: read, simulated with, kept, and written back.
#include <fascia/character/flesh_character.h>
#include <fascia/io/cache/cache.h>
#include <fascia/io/documents/character_file.h>
#include <fascia/io/gltf/gltf_keys.h>
#include <fascia/io/rig_export/rig_player.h>
#include <fascia/io/rig_export/rig_writer.h>
#include <fascia/rig/morph_blend.h>
#include <gmock/gmock.h>

#include "rig_checks.h"
#include "simulated_rig.h"

namespace fascia {
namespace {

using namespace sample;
using testing::ElementsAre;

const std::vector<float> kOpening{0, 1, 0};  // of the smile, by kTimes

// What is said of a tube with two morphs: the top ring goes out along x, the lowest along z.
struct Face {
  std::string names = R"(,"extras":{"targetNames":["smile","frown"]})";
  std::string restWeights{};  // ,"weights":[…]
  bool animated = true;
};

TubeRig tubeWithMorphs(const Face& face = {}) {
  TubeRig rig;
  std::vector<float> smile(36, 0.f), frown(36, 0.f);
  for (std::size_t v = 8; v < 12; ++v) smile[3 * v] = 0.1f;
  for (std::size_t v = 0; v < 4; ++v) frown[3 * v + 2] = 0.2f;
  const std::string targets = R"(,"targets":[{"POSITION":)" +
                              std::to_string(rig.file.add(smile, 3, "VEC3")) + R"(},{"POSITION":)" +
                              std::to_string(rig.file.add(frown, 3, "VEC3")) + "}]";
  std::string mesh = TubeRig::meshOf(rig.primitive(targets));
  mesh.insert(mesh.size() - 1, face.names + face.restWeights);
  rig.file.meshes = "[" + mesh + "]";
  std::string bend = rig.animation(kBend, 2, "rotation", kTimes, kTurns);
  if (face.animated) {
    std::vector<float> weights;
    for (const float w : kOpening) weights.insert(weights.end(), {w, 0.5f});
    const std::string output = std::to_string(rig.file.add(weights, 1, "SCALAR"));
    const std::string input = std::to_string(rig.file.add(kTimes, 1, "SCALAR"));
    const auto insert = [&](const std::string& after, const std::string& text) {
      bend.insert(bend.find(after) + after.size(), text);
    };
    insert(R"("channels":[)", R"({"sampler":1,"target":{"node":3,"path":"weights"}},)");
    insert(R"("interpolation":"LINEAR"})",
           R"(,{"input":)" + input + R"(,"output":)" + output + "}");
  }
  rig.file.animations = "[" + bend + "]";
  return rig;
}

TEST(GltfMorphs, AreReadWithTheirNamesAndWhatTheyMove) {
  const RiggedModel model = imported(tubeWithMorphs());
  ASSERT_EQ(model.morphs.size(), 2u);
  EXPECT_EQ(model.morphs[0].name, "smile");
  EXPECT_EQ(model.morphs[1].name, "frown");
  EXPECT_EQ(model.morphs[0].node, 3);
  EXPECT_EQ(model.morphs[1].target, 1);
  ASSERT_EQ(model.morphs[0].points.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(model.points_m[model.morphs[0].points[k]].y(), 2);
    EXPECT_TRUE(model.morphs[0].displacement_m[k].isApprox(Eigen::Vector3f(0.1f, 0, 0)));
  }
}

TEST(GltfMorphs, WithoutNamesAreNumbered) {
  const RiggedModel model = imported(tubeWithMorphs({.names = ""}));
  EXPECT_EQ(model.morphs.at(0).name, "morph 1");
  EXPECT_EQ(model.morphs.at(1).name, "morph 2");
}

TEST(GltfMorphs, AreThereByTheirWeightsAtRest) {
  const RiggedModel model = imported(tubeWithMorphs({.restWeights = R"(,"weights":[0.5,0])"}));
  EXPECT_EQ(model.morphs.at(0).rest, 0.5f);
  EXPECT_EQ(model.morphs.at(1).rest, 0);
  const RiggedModel plain = imported(tubeWithMorphs());
  for (const std::uint32_t p : model.morphs[0].points)
    EXPECT_NEAR(model.points_m[p].x(), plain.points_m[p].x() + 0.05f, 1e-6f);
}

TEST(GltfMorphs, OfAMotionComeWithItsFrames) {
  const RiggedModel model = imported(tubeWithMorphs());
  ASSERT_EQ(model.motions.size(), 1u);
  const SampledMotion& motion = model.motions[0];
  EXPECT_THAT(motion.morphs, ElementsAre("smile", "frown"));
  EXPECT_NEAR(sampleWeight(motion, 0, 0), 0, 1e-6);
  EXPECT_NEAR(sampleWeight(motion, 0, 0.25), 0.5, 1e-4);
  EXPECT_NEAR(sampleWeight(motion, 0, 0.5), 1, 1e-6);
  EXPECT_NEAR(sampleWeight(motion, 1, 0.3), 0.5, 1e-6);
  EXPECT_EQ(motion.weights.size(), 2 * motion.frameCount());
}

// The tube in two halves that meet in the middle ring, which a morph moves in the lower, and in the
// upper if they stay together.
TubeRig tubeInHalves(bool together) {
  TubeRig rig;
  std::vector<float> moved(36, 0.f);
  for (std::size_t v = 4; v < 8; ++v) moved[3 * v + 1] = 0.1f;
  const int lower = rig.file.add(moved, 3, "VEC3");
  const int upper = together ? lower : rig.file.add(std::vector<float>(36, 0.f), 3, "VEC3");
  const std::vector<std::uint16_t> all = TubeRig::ringIndices();
  const auto half = [&](std::ptrdiff_t first, int target) {
    const int indices = rig.file.add(
        std::vector<std::uint16_t>(all.begin() + first, all.begin() + first + 24), 1, "SCALAR");
    return R"({"attributes":{)" + rig.attributes() + R"(},"indices":)" + std::to_string(indices) +
           R"(,"targets":[{"POSITION":)" + std::to_string(target) + "}]}";
  };
  const std::string halves = half(0, lower) + "," + half(24, upper);
  rig.file.meshes = "[" + TubeRig::meshOf(halves) + "]";
  return rig;
}

TEST(GltfMorphs, KeepPointsApartThatTheyPullApart) {
  EXPECT_EQ(imported(tubeInHalves(true)).points_m.size(), 12u);
  EXPECT_EQ(imported(tubeInHalves(false)).points_m.size(), 16u);
}

TEST(GltfMorphs, OfAHostileFileAreNotTrusted) {
  TubeRig rig = tubeWithMorphs();
  const int few = rig.file.add(std::vector<float>(30, 0.1f), 3, "VEC3");
  std::vector<float> bad(36, 0.1f);
  bad[4] = std::nanf("");
  const int nan = rig.file.add(bad, 3, "VEC3");
  rig.file.meshes =
      "[" +
      TubeRig::meshOf(rig.primitive(R"(,"targets":[{"POSITION":)" + std::to_string(few) +
                                    R"(},{"POSITION":)" + std::to_string(nan) + "}]")) +
      "]";
  const RiggedModel model = imported(rig);
  ASSERT_EQ(model.morphs.size(), 2u);
  EXPECT_TRUE(model.morphs[0].points.empty());
  EXPECT_EQ(model.morphs[1].points.size(), 11u);
  EXPECT_THAT(model.notes, testing::Contains(testing::HasSubstr("another number of vertices")));
  EXPECT_THAT(model.notes, testing::Contains(testing::HasSubstr("are no numbers")));
}

Recording recordAt(const Character& character, double rate_hz) {
  RecordOptions options;
  options.frame_rate_hz = rate_hz;
  return record(character, character.source(0), options);
}

TEST(GltfMorphs, ComeBackFromACache) {
  const Folder folder;
  auto model = std::make_shared<RiggedModel>(readRiggedModel(write(folder, tubeWithMorphs())));
  CharacterDef def = fleshCharacter(model).def;
  const Character character(def);
  const Recording recording = recordAt(character, 20);
  ASSERT_EQ(recording.frames.front().morphs.size(), 2u);
  writeCache(def, recording, folder / "a.fcache");
  const Cache cache = readCache(folder / "a.fcache");
  const RiggedModel& back = *cache.def.rig->model;
  ASSERT_EQ(back.morphs.size(), 2u);
  EXPECT_EQ(back.morphs[0].name, "smile");
  EXPECT_EQ(back.morphs[0].points, model->morphs[0].points);
  EXPECT_EQ(back.motions.at(0).weights, model->motions[0].weights);
  for (std::size_t f = 0; f < recording.frames.size(); ++f)
    EXPECT_EQ(cache.recording.frames[f].morphs, recording.frames[f].morphs);
  const Character again(cache.def);
  EXPECT_EQ(again.morphs().find("frown"), 1);
  Recording broken = recording;
  broken.frames[1].morphs.pop_back();
  EXPECT_THROW(writeCache(def, broken, folder / "b.fcache"), Error);
}

TEST(GltfMorphs, HaveTracksInCharacterFiles) {
  const std::string text = R"({"fascia": 1, "name": "face",
    "skeleton": [{"name": "hip"}],
    "motions": [{"name": "grin",
                 "tracks": [{"morph": "smile", "keys": [[0, 0], [1, 1]]}]}]})";
  const CharacterDef def = readCharacterText(text).def;
  const TrackDef& track = def.motions.at(0).tracks.at(0);
  EXPECT_EQ(track.target, TrackDef::Target::morph);
  EXPECT_EQ(track.name, "smile");
  EXPECT_EQ(track.keys.at(1).value, 1);
  const CharacterDef again = readCharacterText(characterText(def)).def;
  EXPECT_EQ(again.motions, def.motions);
}

// A smile of the file and one that somebody else made, both ways of baking: what players of the
// file show is the recording.
class BakedMorphs : public testing::TestWithParam<bool> {
 protected:
  Folder folder;
  RigBakeReport bake(const Simulated& s) {
    return GetParam() ? writeRigAsMorphs(s.clip(), {}, folder / "out.glb")
                      : writeRigAsBones(s.clip(), {}, folder / "out.glb");
  }
  std::vector<double> played(const Simulated& s, double time_s) {
    const GltfDocument document = GltfDocument::read(folder / "out.glb");
    const RigPlayer player(document, s.model.parts, 0, 1);
    std::vector<double> weights = player.morphWeights(0, time_s);
    weights.resize(2);
    return weights;
  }
};

TEST_P(BakedMorphs, ShowWhatWasSimulatedOnTopOfTheFilesOwn) {
  for (const char* rest : {"", R"(,"weights":[0.25,1])"}) {
    const Simulated s =
        simulate(write(folder, tubeWithMorphs({.restWeights = rest})), 0, 31, 30, swaying);
    const RigBakeReport report = bake(s);
    // Bones turn a face by other helpers than the simulation did: within what they may be off.
    EXPECT_LT(report.error.max_mm, GetParam() ? 0.1 : 0.002 * 2000);
    EXPECT_GT(report.added, 0u);
    for (const double time_s : {0.5, 0.75, 1.0}) {
      EXPECT_NEAR(played(s, time_s)[0], 2 * (time_s - 0.5), 1e-5) << time_s;
      EXPECT_NEAR(played(s, time_s)[1], 0.5, 1e-5);
    }
  }
}

TEST_P(BakedMorphs, KeepTheWeightsOfWhateverElseMovedThem) {
  Simulated s = simulate(write(folder, tubeWithMorphs()), 0, 31, 30, swaying);
  std::vector<Transform> moved;
  for (std::size_t f = 0; f < s.recording.frames.size(); ++f) {
    Recording::Frame& frame = s.recording.frames[f];
    std::vector<double> change = frame.morphs;
    frame.morphs = {0.3, -0.2};
    for (std::size_t m = 0; m < 2; ++m) change[m] = frame.morphs[m] - change[m];
    restToFrame(s.model, s.joints_world[f], moved);
    std::vector<Eigen::Vector3f> shift(s.model.points_m.size(), Eigen::Vector3f::Zero());
    addMorphs(s.model, change, moved, 1, shift);
    for (std::size_t v = 0; v < frame.skin_m.size(); ++v)
      frame.skin_m[v] += shift[s.model.vertices[v].point];
  }
  const RigBakeReport report = bake(s);
  EXPECT_LT(report.error.max_mm, 1);
  EXPECT_NEAR(played(s, 0.9)[0], 0.3, 1e-6);
  EXPECT_NEAR(played(s, 0.9)[1], -0.2, 1e-6);
}

TEST_P(BakedMorphs, RefuseARecordingWithoutThem) {
  Simulated s = simulate(write(folder, tubeWithMorphs()), 0, 4, 30, swaying);
  s.recording.frames[2].morphs.clear();
  EXPECT_THROW(bake(s), Error);
  s.recording.frames[2].morphs = {0, std::nan("")};
  EXPECT_THROW(bake(s), Error);
}

INSTANTIATE_TEST_SUITE_P(BothWays, BakedMorphs, testing::Bool(),
                         [](const auto& p) { return p.param ? "AsMorphs" : "AsBones"; });

}  // namespace
}  // namespace fascia
