#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <thread>

#include <fascia/io/cache/cache.h>
#include <nlohmann/json.hpp>

#include "program.h"

namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

std::string hashOf(const Outcome& outcome) {
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  return outcome.json().at("stats").at("state_hash");
}

TEST_F(Cli, BakeWritesEveryFormatFromOneSimulation) {
  const Outcome outcome =
      run({"bake", "-o", "a.glb", "-o", "a.pc2", "-o", "a.fcache", "ball.fascia.json"});
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(content("a.glb"), StartsWith("glTF"));
  EXPECT_THAT(content("a.pc2"), StartsWith("POINTCACHE2"));
  const fascia::Cache cache = fascia::readCache((folder_ / "a.fcache").string());
  EXPECT_EQ(cache.recording.motion, "hop");
  EXPECT_EQ(cache.recording.frame_rate_hz, 60);
  EXPECT_EQ(cache.recording.frames.size(), 31u);  // 0.5 s, both ends
  EXPECT_EQ(files().size(), 4u);
}

// One small file of both motions, an animation each; every vertex of every frame is larger.
TEST_F(Cli, GridsBecomeSmallFilesOfAllTheirMotions) {
  const Outcome whole = run({"bake", "ball.fascia.json", "--as", "cache", "-o", "whole.glb"});
  ASSERT_EQ(whole.exitCode, 0) << whole.err;
  for (const std::string as : {"", "morphs", "bones"}) {
    std::vector<std::string> command{"bake",  "ball.fascia.json", "--motions", "all", "-o", "a.glb",
                                     "--json"};
    if (!as.empty()) command.insert(command.end(), {"--as", as});
    if (as == "bones") command.insert(command.end(), {"--helpers", "4"});
    const Outcome outcome = run(command);
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const nlohmann::json bake = outcome.json().at("bakes").at(0);
    EXPECT_EQ(bake.at("bytes"), content("a.glb").size());
    EXPECT_LT(content("a.glb").size(), content("whole.glb").size());
    ASSERT_EQ(bake.at("motions").size(), 2u);
    for (const nlohmann::json& motion : bake.at("motions")) {
      EXPECT_LE(motion.at("rms_mm"), motion.at("max_mm"));
      EXPECT_LT(motion.at("rms_percent"), 0.5);
    }
    for (const char* name : {"\"hop\"", "\"rest\""}) EXPECT_THAT(content("a.glb"), HasSubstr(name));
    EXPECT_EQ(content("a.glb").find("fascia_helper_01") != std::string::npos, as == "bones");
  }
}

TEST_F(Cli, OptionsOfOneWayToBakeAGridAreRefusedWithTheOther) {
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{"--helpers", "3", "-o", "a.glb"},
                                             {"--as", "bones", "--targets", "3", "-o", "a.glb"},
                                             {"--as", "cache", "--targets", "3", "-o", "a.glb"},
                                             {"--as", "bones", "-o", "a.pc2"}}) {
    std::vector<std::string> command{"bake", "ball.fascia.json"};
    command.insert(command.end(), options.begin(), options.end());
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exitCode, 1) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("leave --"));
    EXPECT_FALSE(exists("a.glb") || exists("a.pc2"));
  }
}

TEST_F(Cli, BakeObeysItsOptions) {
  const Outcome outcome = run({"bake", "ball.fascia.json", "--motion", "rest", "--fps", "30",
                               "--grid", "24x16", "--duration", "0.4", "-o", "a.fcache"});
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  const fascia::Recording recording = fascia::readCache((folder_ / "a.fcache").string()).recording;
  EXPECT_EQ(recording.motion, "rest");
  EXPECT_EQ(recording.frame_rate_hz, 30);
  EXPECT_EQ(recording.frames.size(), 13u);
  EXPECT_EQ(recording.skin.positions.size(), 25u * 16 + 2);
}

TEST_F(Cli, StatsHoldWhatIsPromised) {
  run({"bake", "ball.fascia.json", "-o", "a.pc2", "--stats", "stats.json"});
  const nlohmann::json stats = nlohmann::json::parse(content("stats.json"));
  for (const char* key :
       {"vertices", "simulated_s", "wall_s", "realtime_ratio", "steps", "rejected_steps",
        "step_min_s", "step_max_s", "share_forces", "share_constraints", "share_other",
        "max_penetration_m", "max_face_depth_m", "max_edge_stretch", "peak_memory_bytes",
        "state_hash"})
    EXPECT_TRUE(stats.contains(key)) << key;
  EXPECT_GT(stats.at("steps"), 0);
  EXPECT_DOUBLE_EQ(stats.at("simulated_s"), 0.5);
  const double shares = stats.at("share_forces").get<double>() +
                        stats.at("share_constraints").get<double>() +
                        stats.at("share_other").get<double>();
  EXPECT_NEAR(shares, 1, 1e-6);
}

TEST_F(Cli, StateHashIsTheSameForAnyNumberOfThreads) {
  const auto bake = [&](const char* threads, const char* motion) {
    return hashOf(run({"bake", "ball.fascia.json", "--json", "--grid", "64x32", "--motion", motion,
                       "--threads", threads, "-o", "a.pc2"}));
  };
  const std::string one = bake("1", "hop");
  EXPECT_EQ(one.size(), 16u);
  EXPECT_EQ(bake("2", "hop"), one);
  EXPECT_EQ(bake("4", "hop"), one);
  EXPECT_NE(bake("1", "rest"), one);
}

TEST_F(Cli, NothingIsSimulatedForAFolderThatIsNotThere) {
  const Outcome outcome = run({"bake", "ball.fascia.json", "-o", "missing/a.glb"});
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_THAT(outcome.err, HasSubstr("there is no folder 'missing'"));
}

TEST_F(Cli, AFailedBakeLeavesTheOldFileAlone) {
  write("a.glb", "precious");
  write("bad.fascia.json", "{\"fascia\": 1");
  EXPECT_EQ(run({"bake", "bad.fascia.json", "-o", "a.glb"}).exitCode, 1);
  EXPECT_EQ(content("a.glb"), "precious");
}

// Whenever the signal comes, nothing half-written stays.
TEST_F(Cli, InterruptedBakeLeavesNothingBehind) {
  for (const int signal : {SIGINT, SIGTERM}) {
    Process bake(folder_, {"bake", "ball.fascia.json", "--duration", "80000", "-o", "a.glb"});
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_TRUE(bake.running());
    bake.send(signal);
    const Outcome outcome = bake.wait();
    EXPECT_EQ(outcome.signal, signal);
    EXPECT_THAT(files(), ElementsAre("ball.fascia.json"));
  }
}

}  // namespace
