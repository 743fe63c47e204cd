#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include <fascia/io/cache/cache.h>
#include <fascia/io/cache/scene_cache.h>
#include <fascia/io/file/file.h>

#include "character/small_character.h"
#include "sample.h"
#include "scene_sample.h"

namespace fascia {
namespace {

using testing::HasSubstr;

// A solid, the inside of a mesh, a character with a skin and a script.
SceneDef everything() {
  SceneDef def;
  def.name = "everything";
  SceneBodyDef& ball = def.bodies.emplace_back();
  ball.name = "ball";
  ball.solid.shape = "sphere";
  ball.solid.parameters = {0.2};
  ball.position_m = Vec3(0.5, 1, 0);
  ball.spin_rad_per_s = Vec3(1, 2, 3);
  SceneBodyDef& box = def.bodies.emplace_back();
  box.name = "box";
  box.form = SceneBodyDef::Form::mesh;
  box.mesh_file = "box.glb";
  box.mesh = std::make_shared<const TriangleMesh>(sample::boxMesh({0.1, 0.2, 0.3}));
  box.basis.kind = BodyBasisDef::Kind::polynomial;
  box.position_m = Vec3(0, 2, 1);
  SceneCharacterDef& doll = def.characters.emplace_back();
  doll.name = "doll";
  doll.file = "doll.fascia.json";
  doll.position_m = Vec3(2, 0, 1);
  doll.heading_rad = 0.5;
  doll.character = std::make_shared<const Character>(test::smallCharacter());
  def.ground = GroundDef{};
  def.script = "act.lua";
  def.script_text = "wait(0.1)\nfail('so be it')\n";
  return def;
}

// A cache written once, and pieces of it to find in its bytes.
class SceneCacheTest : public testing::Test {
 protected:
  struct Written {
    Stage stage{everything()};
    StageRecording recording = record(stage, {.duration_s = 0.2});
    std::string bytes = bytesOf(stage, recording);
  };
  static const Written& written() {
    static const Written kWritten;
    return kWritten;
  }

  static std::string bytesOf(const Stage& stage, const StageRecording& recording) {
    const sample::Folder folder;
    writeSceneCache(stage, recording, folder / "a.fcache");
    EXPECT_EQ(folder.entryCount(), 1u);
    return readCacheBytes(folder / "a.fcache");
  }

  template <class T>
  static std::size_t placeOf(const std::vector<T>& values) {
    const std::string part(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    return written().bytes.find(part);
  }
  template <class T>
  static std::string patched(std::size_t at, T value) {
    std::string out = written().bytes;
    EXPECT_LE(at + sizeof value, out.size());
    std::memcpy(out.data() + at, &value, sizeof value);
    return out;
  }

  static void expectRefused(const std::string& bytes, const std::string& message) {
    try {
      parseSceneCache(bytes, "a.fcache");
      ADD_FAILURE() << "was read, expected: " << message;
    } catch (const Error& error) {
      EXPECT_EQ(error.issues().front().where.file, "a.fcache");
      EXPECT_THAT(error.what(), HasSubstr(message));
    }
  }
};

TEST_F(SceneCacheTest, WhatIsReadHasTheSameBits) {
  const StageRecording& recording = written().recording;
  const SceneCache cache = parseSceneCache(written().bytes);
  ASSERT_EQ(cache.recording.frames.size(), 13u);
  EXPECT_NE(recording.frames.front().bodies, recording.frames.back().bodies);
  for (std::size_t f = 0; f < recording.frames.size(); ++f) {
    EXPECT_EQ(cache.recording.frames[f].time_s, recording.frames[f].time_s);
    EXPECT_EQ(cache.recording.frames[f].bodies, recording.frames[f].bodies);
    EXPECT_EQ(cache.recording.characters[0].frames[f].skin_m,
              recording.characters[0].frames[f].skin_m);
    EXPECT_EQ(cache.recording.characters[0].frames[f].posture,
              recording.characters[0].frames[f].posture);
  }
  EXPECT_EQ(cache.recording.frame_rate_hz, 60);
  EXPECT_EQ(cache.recording.outcome, ScriptOutcome::failed);
  EXPECT_EQ(cache.recording.reason, "so be it");
  EXPECT_EQ(cache.recording.state_hash, recording.state_hash);
  EXPECT_EQ(cache.recording.bodies.steps, recording.bodies.steps);
  EXPECT_EQ(cache.recording.simulated_s, recording.simulated_s);
}

TEST_F(SceneCacheTest, HoldsNoTimesThatWereMeasured) {
  StageRecording slow = written().recording;
  slow.wall_s += 9;
  slow.characters[0].stats.other_s += 9;
  EXPECT_TRUE(bytesOf(written().stage, slow) == written().bytes);
}

TEST_F(SceneCacheTest, TheStageComesBackWithItsCharactersAndMeshes) {
  const SceneCache cache = parseSceneCache(written().bytes);
  const SceneDef &def = written().stage.def(), &back = cache.stage.def();
  EXPECT_EQ(sceneText(back), sceneText(def));
  EXPECT_EQ(back.bodies[1].mesh->positions, def.bodies[1].mesh->positions);
  EXPECT_EQ(back.bodies[1].mesh->triangles, def.bodies[1].mesh->triangles);
  EXPECT_EQ(back.characters[0].character->def().name, "doll");
  ASSERT_EQ(cache.textures.size(), 1u);
  for (const BodyId id : {BodyId(0), BodyId(1)}) {
    EXPECT_EQ(cache.stage.look(id).positions, written().stage.look(id).positions);
    EXPECT_EQ(cache.stage.bodies().shape(id).mass_kg(),
              written().stage.bodies().shape(id).mass_kg());
  }
}

TEST_F(SceneCacheTest, WritingAgainGivesTheSameFile) {
  const SceneCache cache = parseSceneCache(written().bytes);
  EXPECT_EQ(bytesOf(cache.stage, cache.recording), written().bytes);
}

TEST_F(SceneCacheTest, KindsOfCachesAreToldApart) {
  const std::string character =
      cacheBytes(readCharacterText(sample::kFull).def, sample::tube(3, 3));
  EXPECT_TRUE(isSceneCache(written().bytes));
  EXPECT_FALSE(isSceneCache(character));
  EXPECT_TRUE(isCache(character));
  EXPECT_FALSE(isCache(written().bytes));
  expectRefused(character, "not a Fascia scene cache");
  EXPECT_THROW(parseCache(written().bytes), Error);
}

TEST_F(SceneCacheTest, CutShortAnywhereItIsRefused) {
  const std::string& bytes = written().bytes;
  ASSERT_GT(bytes.size(), 1000u);
  const std::size_t stride = bytes.size() / 6;
  for (std::size_t end = 0; end < bytes.size(); end += end < 20 ? 1 : stride)
    EXPECT_THROW(parseSceneCache(bytes.substr(0, end)), Error) << end;
  for (const std::size_t cut : {1, 8, 60})
    expectRefused(bytes.substr(0, bytes.size() - cut), "cut short");
  expectRefused(bytes + "x", "after its end");
}

TEST_F(SceneCacheTest, HeadersOfOthersAreRefused) {
  expectRefused(patched(0, 'X'), "not a Fascia scene cache");
  expectRefused(patched(8, std::uint32_t{3}), "format 3");
  expectRefused(patched(12, std::numeric_limits<std::uint64_t>::max()), "cut short");
}

TEST_F(SceneCacheTest, WrongCountsAndRatesAreRefused) {
  const std::size_t first = placeOf(written().recording.frames.front().bodies);
  ASSERT_NE(first, std::string::npos);
  const std::size_t count = first - 2 * sizeof(double), rate = count - sizeof(double);
  expectRefused(patched(count, std::uint64_t{1} << 60), "cut short");
  expectRefused(patched(rate, 0.0), "frame rate");
  expectRefused(patched(rate, std::nan("")), "frame rate");
  StageRecording recording = written().recording;
  recording.characters[0].frames.pop_back();
  expectRefused(bytesOf(written().stage, recording), "another number of frames");
}

TEST_F(SceneCacheTest, NumbersThatAreNoneAreRefused) {
  const float infinity = std::numeric_limits<float>::infinity();
  const std::size_t frame = placeOf(written().recording.frames[5].bodies);
  const std::size_t mesh = placeOf(everything().bodies[1].mesh->positions);
  ASSERT_NE(frame, std::string::npos);
  ASSERT_NE(mesh, std::string::npos);
  for (const std::size_t at : {frame, frame - sizeof(double)})
    expectRefused(patched(at, std::nan("")), "not a finite number");
  expectRefused(patched(mesh, infinity), "not a finite number");
}

TEST_F(SceneCacheTest, MeshesAndOutcomesThatCannotBeAreRefused) {
  const std::size_t triangles = placeOf(everything().bodies[1].mesh->triangles);
  ASSERT_NE(triangles, std::string::npos);
  expectRefused(patched(triangles, std::uint32_t{8}), "points nowhere");
  expectRefused(patched(triangles - 8, std::uint64_t{1} << 62), "cut short");
  const std::size_t reason = written().bytes.rfind("so be it");
  expectRefused(patched(reason - 9, std::uint8_t{3}), "outcome");
}

TEST_F(SceneCacheTest, RecordingsOfOtherScenesAreNotWritten) {
  const sample::Folder folder;
  StageRecording recording = written().recording;
  recording.frames[3].bodies.pop_back();
  EXPECT_THROW(writeSceneCache(written().stage, recording, folder / "a.fcache"), Error);
  EXPECT_EQ(folder.entryCount(), 0u);
}

}  // namespace
}  // namespace fascia
