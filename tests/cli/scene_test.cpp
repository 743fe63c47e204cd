#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include <fascia/io/cache/cache.h>
#include <fascia/io/cache/mdd.h>
#include <fascia/io/cache/pc2.h>
#include <fascia/io/cache/scene_cache.h>
#include <nlohmann/json.hpp>

#include "program.h"

namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const std::filesystem::path kSceneExamples = FASCIA_SOURCE_DIR "/examples";

// Two plates, one of them led by a script, beside the ball, which stands.
constexpr const char* kScene = R"({
  "fascia": 1,
  "kind": "scene",
  "name": "swing",
  "dimension": 2,
  "bodies": [
    {"name": "bob",
     "outline_m": [[-0.2, -0.1], [0.2, -0.1], [0.2, 0.1], [-0.2, 0.1]],
     "position_m": [0, 1], "points": {"end": [0.2, 0]},
     "scatter": {"position_m": [0.3, 0.1]}},
    {"name": "slab", "basis": "quadratic",
     "outline_m": [[-0.3, 0], [0.3, 0], [0.3, 0.1], [-0.3, 0.1]],
     "position_m": [1, 0.2], "density_kg_per_m3": 200, "thickness_m": 0.1}
  ],
  "places": {"hook": [0, 2]},
  "constraints": [{"type": "rod", "points": ["bob.end", "hook"]}],
  "ground": {},
  "script": "swing.lua",
  "simulation": {"duration_s": 0.4, "frame_rate_hz": 30}
}
)";
constexpr const char* kScript = R"(log('begin')
wait(0.1)
impulse('bob', vec(1, 0, 0))
succeed()
)";

class CliScene : public Cli {
 protected:
  CliScene() {
    write("swing.fascia.json", kScene);
    write("swing.lua", kScript);
    inputs_ = files();
  }
  std::string hashOf(std::vector<std::string> options) const {
    options.insert(options.begin(), {"bake", "swing.fascia.json", "-o", "a.pc2", "--json"});
    const Outcome outcome = run(options);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    return outcome.json().at("stats").at("state_hash");
  }
  void expectRefused(const std::vector<std::string>& arguments, const std::string& told) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 1) << testing::PrintToString(arguments);
    EXPECT_THAT(outcome.err, HasSubstr(told));
    EXPECT_EQ(files(), inputs_);
    EXPECT_EQ(content("swing.fascia.json"), kScene);
    EXPECT_EQ(content("swing.lua"), kScript);
  }

  std::vector<std::string> inputs_;
};

TEST_F(CliScene, CheckReadsTheSceneAndItsScript) {
  EXPECT_THAT(run({"check", "swing.fascia.json"}).out,
              testing::StartsWith("swing.fascia.json: ok\n"));
  write("swing.lua", "wait(1)\nwait(\n");
  const Outcome outcome = run({"check", "swing.fascia.json"});
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_THAT(outcome.err, HasSubstr("swing.lua:3"));
  std::string text = kScene;
  text.replace(text.find("\"rod\""), 5, "\"rood\"");
  write("swing.fascia.json", text);
  EXPECT_THAT(run({"check", "swing.fascia.json"}).err,
              HasSubstr("swing.fascia.json:16: /constraints/0/type"));
}

TEST_F(CliScene, BakeWritesEveryFormatFromOnePerformance) {
  const Outcome outcome = run(
      {"bake", "swing.fascia.json", "-o", "a.glb", "-o", "a.pc2", "-o", "a.mdd", "-o", "a.fcache"});
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("begin"));
  EXPECT_THAT(content("a.glb"), StartsWith("glTF"));
  const fascia::SceneCache cache = fascia::parseSceneCache(content("a.fcache"));
  EXPECT_EQ(cache.recording.frames.size(), 13u);  // 0.4 s, both ends
  const fascia::MddCache mdd = fascia::readMdd((folder_ / "a.mdd").string());
  std::size_t points = 0;
  for (const char* name : {"bob", "slab"})
    points += cache.stage.look(cache.stage.findPoint(name)->body).positions.size();
  EXPECT_EQ(mdd.pointCount, points);
  EXPECT_EQ(mdd.times_s.size(), 13u);
  EXPECT_THAT(content("a.pc2"), StartsWith("POINTCACHE2"));
  EXPECT_EQ(files().size(), inputs_.size() + 4);
}

TEST_F(CliScene, StatsHoldWhatIsPromised) {
  run({"bake", "swing.fascia.json", "-o", "a.pc2", "--stats", "stats.json"});
  const nlohmann::json stats = nlohmann::json::parse(content("stats.json"));
  for (const char* key :
       {"scene", "bodies", "coordinates", "frames", "simulated_s", "wall_s", "realtime_ratio",
        "steps", "iterations", "halved_steps", "unconverged_steps", "stopped_steps", "outcome",
        "log", "characters", "peak_memory_bytes", "state_hash"})
    EXPECT_TRUE(stats.contains(key)) << key;
  EXPECT_EQ(stats.at("outcome"), "succeeded");
  EXPECT_EQ(stats.at("bodies"), 2);
  EXPECT_EQ(stats.at("coordinates"), 2 * 3 + 2 * 6);
  EXPECT_EQ(stats.at("log").at(0).at("text"), "begin");
  EXPECT_NEAR(stats.at("simulated_s"), 0.4, 1e-9);
  EXPECT_GE(stats.at("steps"), 12 * 4);
}

TEST_F(CliScene, SeedsChangeTheResultAndThreadsDoNot) {
  const std::string seven = hashOf({"--seed", "7", "--threads", "1"});
  EXPECT_EQ(seven.size(), 16u);
  EXPECT_EQ(hashOf({"--seed", "7", "--threads", "2"}), seven);
  EXPECT_EQ(hashOf({"--seed", "7", "--threads", "4"}), seven);
  EXPECT_NE(hashOf({"--seed", "8"}), seven);
  EXPECT_NE(hashOf({}), seven);
}

TEST_F(CliScene, BakeObeysDurationAndRate) {
  run({"bake", "swing.fascia.json", "--duration", "0.2", "--fps", "60", "-o", "a.fcache"});
  const fascia::SceneCache cache = fascia::parseSceneCache(content("a.fcache"));
  EXPECT_EQ(cache.recording.frame_rate_hz, 60);
  EXPECT_EQ(cache.recording.frames.size(), 13u);
}

TEST_F(CliScene, AScriptsErrorNamesItsLineAndLeavesNothing) {
  write("swing.lua", "wait(0.1)\nhold('bab')\n");
  const std::vector<std::string> before = files();
  for (const char* output : {"a.glb", "a.mp4"}) {
    const char* command = std::string(output) == "a.mp4" ? "render" : "bake";
    const Outcome outcome = run({command, "swing.fascia.json", "-o", output});
    EXPECT_EQ(outcome.exitCode, 1);
    EXPECT_THAT(outcome.err, HasSubstr("swing.lua:2"));
    EXPECT_THAT(outcome.err, HasSubstr("'bab'"));
    EXPECT_EQ(files(), before);
  }
}

TEST_F(CliScene, OptionsOfCharactersAreRefusedAndViceVersa) {
  expectRefused({"bake", "swing.fascia.json", "-o", "a.glb", "--motion", "hop"}, "--motion");
  expectRefused({"bake", "swing.fascia.json", "-o", "a.glb", "--as", "bones"}, "--as");
  expectRefused({"bake", "ball.fascia.json", "-o", "a.glb", "--seed", "3"}, "--seed");
}

TEST_F(CliScene, OptionsThatWouldChangeNothingAreRefused) {
  expectRefused({"bake", "swing.fascia.json", "-o", "a.glb", "--step", "0"}, "--step 0");
  expectRefused({"bake", "swing.fascia.json", "-o", "a.glb", "--step", "0.04"}, "0.03333 s");
  expectRefused({"bake", "swing.fascia.json", "-o", "a.glb", "--grid", "8x8"}, "--grid");
  expectRefused({"bake", "swing.fascia.json", "-o", "a.glb", "--integrator", "leapfrog"},
                "--integrator");
  EXPECT_NE(hashOf({"--step", "0.001"}), hashOf({}));
}

TEST_F(CliScene, ScriptsKnowTheGravityWhichMayBeTwoNumbersInThePlane) {
  std::string text = kScene;
  text.replace(text.find("\"simulation\": {"), 15,
               "\"simulation\": {\"gravity_m_per_s2\": [0.5, -3], ");
  write("swing.fascia.json", text);
  write("swing.lua", "local g = gravity()\nlog('gravity', g.x, g.y, g.z)\n");
  EXPECT_THAT(run({"bake", "swing.fascia.json", "-o", "a.pc2"}).out,
              HasSubstr("gravity 0.5 -3.0 0.0"));
}

// The monster's script, its prey scattered over `reach_m` at up to `speed_m_per_s`.
std::string monster(double gravity, double reach_m, double speed_m_per_s) {
  auto scene =
      nlohmann::json::parse(readWhole(kSceneExamples / "hinge-horned-monster.fascia.json"));
  scene["simulation"]["gravity_m_per_s2"] = {0, -gravity};
  scene["simulation"]["frame_rate_hz"] = 30;
  for (auto& body : scene["bodies"])
    if (body["name"] == "man")
      body["scatter"] = {{"position_m", {reach_m, 0}}, {"velocity_m_per_s", {speed_m_per_s, 0}}};
  return scene.dump();
}

TEST_F(CliScene, TheMonstersReflexWorksInAnyGravityAndFromFarAway) {
  write("hinge-horned-monster.lua", readWhole(kSceneExamples / "hinge-horned-monster.lua"));
  for (const std::string& scene :
       {monster(0, 0.6, 0.8), monster(24.5, 0.6, 0.8), monster(9.81, 2.4, 3.2)}) {
    write("monster.fascia.json", scene);
    for (const char* seed : {"1", "6"}) {
      const Outcome bake = run({"bake", "monster.fascia.json", "-o", "m.pc2", "--seed", seed});
      EXPECT_THAT(bake.out, HasSubstr("the script has succeeded")) << scene << " " << seed;
    }
  }
}

// A point of a sphere nailed to two places 0.5 m apart, or twice to the same.
std::string nailedTwice(const std::string& second) {
  return R"({"fascia": 1, "kind": "scene", "name": "c",
    "bodies": [{"name": "a", "shape": "sphere", "radius_m": 0.3, "position_m": [0, 2, 0],
                "points": {"p": [0, 0.3, 0]}}],
    "places": {"x": [0, 2.3, 0], "y": [0.3, 2.7, 0]},
    "constraints": [{"name": "one", "type": "nail", "points": ["a.p", "x"]},
                    {"name": "two", "type": "nail", "points": ["a.p", ")" +
         second + R"("]}],
    "simulation": {"duration_s": 0.1}})";
}

TEST_F(CliScene, ConstraintsThatContradictAreNamedWithTheirDistance) {
  write("conflict.fascia.json", nailedTwice("y"));
  const Outcome check = run({"check", "conflict.fascia.json"});
  EXPECT_EQ(check.exitCode, 0);
  EXPECT_THAT(check.out, StartsWith("conflict.fascia.json: ok, 1 warning"));
  for (const char* told : {"conflict.fascia.json: constraint", "'one'", "'two'", "0.5 m away"})
    EXPECT_THAT(check.err, HasSubstr(told));
  const Outcome bake =
      run({"bake", "conflict.fascia.json", "-o", "c.pc2", "--stats", "c.json", "--json"});
  EXPECT_THAT(bake.err, HasSubstr("0.5 m away"));
  const auto checked = run({"check", "conflict.fascia.json", "--json"}).json();
  for (const auto& found : {checked.at("constraints"), bake.json().at("stats").at("constraints"),
                            nlohmann::json::parse(content("c.json")).at("constraints")}) {
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].at("kind"), "conflict");
    EXPECT_EQ(found[0].at("rows"), 3);
    EXPECT_NEAR(found[0].at("distance_m").get<double>(), 0.5, 1e-6);
    EXPECT_NE(found[0].at("constraint"), found[0].at("with").at(0));
  }
}

TEST_F(CliScene, ConstraintsThatSayTheSameTwiceAreANote) {
  write("same.fascia.json", nailedTwice("x"));
  const Outcome check = run({"check", "same.fascia.json"});
  EXPECT_THAT(check.out, StartsWith("same.fascia.json: ok\n"));
  EXPECT_THAT(check.err, StartsWith("note: constraint "));
  EXPECT_THAT(check.err, testing::Not(HasSubstr("away")));
  const auto checked = run({"check", "same.fascia.json", "--json"}).json();
  EXPECT_EQ(checked.at("constraints").at(0).at("kind"), "redundant");
  EXPECT_TRUE(checked.at("warnings").empty());
}

TEST_F(CliScene, InputsAreNotOverwritten) {
  std::string text = kScene;
  text.replace(text.find("swing.lua"), 9, "swing.glb");
  write("other.fascia.json", text);
  write("swing.glb", kScript);
  inputs_ = files();
  expectRefused({"bake", "other.fascia.json", "-o", "swing.glb"}, "swing.glb");
  expectRefused({"bake", "other.fascia.json", "-o", "./swing.glb"}, "swing.glb");
  expectRefused({"bake", "swing.fascia.json", "-o", "a.glb", "--stats", "swing.lua"}, "swing.lua");
  expectRefused({"bake", "swing.fascia.json", "-o", "a.glb", "--stats", "swing.fascia.json"},
                "swing.fascia.json");
  expectRefused({"render", "swing.fascia.json", "-o", "a.png", "--stats", "swing.fascia.json"},
                "swing.fascia.json");
  EXPECT_EQ(content("swing.glb"), kScript);
}

TEST_F(CliScene, InterruptedBakeLeavesNothingBehind) {
  Process bake(folder_, {"bake", "swing.fascia.json", "--duration", "80000", "-o", "a.glb"});
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_TRUE(bake.running());
  bake.send(SIGINT);
  EXPECT_EQ(bake.wait().signal, SIGINT);
  EXPECT_EQ(files(), inputs_);
}

TEST_F(CliScene, InfoTellsWhatASceneHolds) {
  const nlohmann::json info = run({"info", "swing.fascia.json", "--json"}).json();
  EXPECT_EQ(info.at("name"), "swing");
  EXPECT_EQ(info.at("dimension"), 2);
  ASSERT_EQ(info.at("bodies").size(), 2u);
  const nlohmann::json& slab = info.at("bodies").at(1);
  EXPECT_EQ(slab.at("name"), "slab");
  EXPECT_NEAR(slab.at("mass_kg"), 0.6 * 0.1 * 0.1 * 200, 1e-9);
  EXPECT_EQ(slab.at("coordinates"), 12);
  EXPECT_EQ(info.at("constraints"), 1);
  EXPECT_EQ(info.at("places").at(0).at("name"), "hook");
  EXPECT_EQ(info.at("script"), "swing.lua");
  EXPECT_EQ(info.at("duration_s"), 0.4);
  EXPECT_THAT(info.at("characters"), IsEmpty());
  EXPECT_THAT(run({"info", "swing.fascia.json"}).out, HasSubstr("slab, 1.2 kg"));
}

TEST_F(CliScene, InfoTellsOfCharactersAndOfPerformances) {
  std::string text = kScene;
  text.replace(text.find("\"ground\""), 8,
               R"("characters": [{"name": "doll", "file": "ball.fascia.json"}], "ground")");
  write("swing.fascia.json", text);
  const nlohmann::json baked =
      run({"bake", "swing.fascia.json", "--json", "-o", "a.fcache"}).json();
  const nlohmann::json info = run({"info", "a.fcache", "--json"}).json();
  EXPECT_EQ(info.at("name"), "swing");
  EXPECT_EQ(info.at("characters").at(0).at("name"), "doll");
  EXPECT_EQ(info.at("characters").at(0).at("motion"), "hop");
  EXPECT_EQ(info.at("frames"), 13);
  EXPECT_EQ(info.at("recorded_hz"), 30);
  EXPECT_EQ(info.at("outcome"), "succeeded");
  EXPECT_EQ(info.at("state_hash"), baked.at("stats").at("state_hash"));
}

class CliSceneRender : public CliScene {
 protected:
  void SetUp() override {
    const std::string opengl = run({"info", "--json"}).json().at("opengl");
    if (opengl.starts_with("none")) GTEST_SKIP() << opengl;
  }
};

TEST_F(CliSceneRender, SceneAndItsCacheGiveTheSamePicture) {
  ASSERT_EQ(run({"bake", "swing.fascia.json", "-o", "a.fcache"}).exitCode, 0);
  const auto draw = [&](const char* from, const char* to, const char* time_s) {
    const Outcome outcome = run({"render", from, "-o", to, "--size", "160x120", "--time", time_s});
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    return content(to);
  };
  const std::string picture = draw("a.fcache", "a.png", "0.3");
  EXPECT_EQ(picture.substr(1, 3), "PNG");
  EXPECT_TRUE(draw("swing.fascia.json", "b.png", "0.3") == picture);
  EXPECT_FALSE(draw("a.fcache", "c.png", "0") == picture);
  EXPECT_EQ(run({"render", "a.fcache", "-o", "d.png", "--time", "7"}).exitCode, 1);
  EXPECT_FALSE(exists("d.png"));
}

TEST_F(CliSceneRender, VideosSimulateAsBakeDoes) {
  const Outcome rendered =
      run({"render", "swing.fascia.json", "--json", "-o", "a.mp4", "--size", "64x48"});
  ASSERT_EQ(rendered.exitCode, 0) << rendered.err;
  EXPECT_TRUE(exists("a.mp4"));
  EXPECT_EQ(rendered.json().at("stats").at("state_hash"), hashOf({}));
}

}  // namespace
