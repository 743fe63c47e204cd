#include <gmock/gmock.h>

#include <filesystem>

#include <fascia/io/cache/cache.h>
#include <nlohmann/json.hpp>

#include "program.h"
#include "rigged.h"

namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::StartsWith;

// A scratch folder with a rigged file and a character on it.
class CliRig : public Cli {
 protected:
  CliRig() {
    write("tube.gltf", riggedGltf());
    write("tube.fascia.json", riggedCharacter());
  }

  // The character's text with one piece replaced.
  void rewrite(const std::string& from, const std::string& to) {
    std::string text = riggedCharacter();
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write("tube.fascia.json", text.replace(at, from.size(), to));
  }
};

TEST_F(CliRig, CheckAcceptsACharacterOnARig) {
  const Outcome outcome = run({"check", "tube.fascia.json"});
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
}

TEST_F(CliRig, RigOutsideOfTheFolderIsRefusedWithALine) {
  const std::string outside = (folder_ / "tube.gltf").string();
  for (const std::string& name :
       {std::string("../tube.gltf"), outside, std::string("a/../x.glb")}) {
    rewrite("\"tube.gltf\"", '"' + name + '"');
    const Outcome outcome = run({"check", "tube.fascia.json"});
    EXPECT_EQ(outcome.exitCode, 1) << name;
    EXPECT_THAT(outcome.err, HasSubstr("tube.fascia.json:4: /rig/file: the rig must be named by a "
                                       "path inside this file's folder"));
  }
}

TEST_F(CliRig, LinkOutOfTheFolderIsRefused) {
  std::filesystem::create_directory(folder_ / "inner");
  write("inner/tube.fascia.json", riggedCharacter());
  std::filesystem::create_symlink(folder_ / "tube.gltf", folder_ / "inner/tube.gltf");
  const Outcome outcome = run({"check", "inner/tube.fascia.json"});
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_THAT(outcome.err, HasSubstr("leads out of this file's folder"));
}

TEST_F(CliRig, MissingAndBrokenRigsAreNamed) {
  rewrite("tube.gltf", "tub.gltf");
  EXPECT_THAT(run({"check", "tube.fascia.json"}).err,
              HasSubstr("tube.fascia.json:4: /rig/file: the rig is missing: tub.gltf"));
  rewrite("tube.gltf", "broken.gltf");
  write("broken.gltf", "{\"asset\": ");
  const Outcome broken = run({"info", "tube.fascia.json"});
  EXPECT_EQ(broken.exitCode, 1);
  EXPECT_THAT(broken.err, HasSubstr("tube.fascia.json:4: /rig/file: the rig "));
  EXPECT_THAT(broken.err, HasSubstr("broken.gltf"));
}

TEST_F(CliRig, InfoTellsOfTheRigBareOrInACharacter) {
  for (const char* file : {"tube.gltf", "tube.fascia.json"}) {
    const Outcome outcome = run({"info", file, "--json"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const nlohmann::json rig = outcome.json();
    EXPECT_EQ(rig.at("rig_joints"), 2);
    EXPECT_EQ(rig.at("rig_points"), 112);
    EXPECT_EQ(rig.at("rig_triangles"), 220);
    EXPECT_EQ(rig.at("rig_pieces"), 1);
    EXPECT_NEAR(rig.at("rig_height_m"), 1, 1e-6);
    EXPECT_EQ(rig.at("rig_materials").at(0).at("name"), "rubber");
    EXPECT_EQ(rig.at("motions").at(0).at("name"), "bend");
    EXPECT_NEAR(rig.at("motions").at(0).at("duration_s"), 0.5, 0.02);
  }
}

TEST_F(CliRig, UnknownMotionNamesTheRigs) {
  const Outcome outcome = run({"bake", "tube.fascia.json", "--motion", "bent", "-o", "a.fcache"});
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_THAT(outcome.err, HasSubstr("bend, sway"));
  EXPECT_THAT(outcome.err, HasSubstr("did you mean 'bend'?"));
}

TEST_F(CliRig, CacheHoldsTheRig) {
  const Outcome outcome = run({"bake", "tube.fascia.json", "--motion", "sway", "-o", "a.fcache"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  std::filesystem::remove(folder_ / "tube.gltf");
  const fascia::Cache cache = fascia::readCache((folder_ / "a.fcache").string());
  ASSERT_TRUE(cache.def.rig && cache.def.rig->model);
  EXPECT_EQ(cache.def.rig->model->points_m.size(), 112u);
  EXPECT_EQ(cache.recording.motion, "sway");
  EXPECT_EQ(cache.recording.skin.positions.size(), cache.def.rig->model->vertices.size());
  EXPECT_EQ(run({"info", "a.fcache"}).exitCode, 0);
}

// Motions, joints and materials of the file stay; how faithful the bake is gets told.
TEST_F(CliRig, BakesBackIntoItsFileInThreeWays) {
  for (const std::string as : {"bones", "morphs", "cache"}) {
    std::vector<std::string> command{"bake", "tube.fascia.json", "--motion", "bend", "--as", as,
                                     "-o",   as + ".glb",        "--json"};
    if (as == "bones") command.insert(command.end(), {"--helpers", "3"});
    if (as == "morphs") command.insert(command.end(), {"--targets", "4"});
    const Outcome outcome = run(command);
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_THAT(content(as + ".glb"), StartsWith("glTF"));
    const nlohmann::json bake = outcome.json().at("bakes").at(0);
    EXPECT_LE(bake.at("rms_mm"), bake.at("max_mm"));
    EXPECT_LT(bake.at("rms_percent"), 2);
    EXPECT_NEAR(bake.at("rms_percent"), 0.1 * bake.at("rms_mm").get<double>(), 1e-6);  // of 1 m
  }
  for (const char* file : {"cache.pc2", "cache.mdd"}) EXPECT_TRUE(exists(file)) << file;
  const Outcome again = run({"info", "bones.glb", "--json"});
  ASSERT_EQ(again.exitCode, 0) << again.err;
  EXPECT_GE(again.json().at("rig_joints"), 2 + 3);  // more if the error asks for them
  EXPECT_EQ(again.json().at("rig_materials").at(0).at("name"), "rubber");
  EXPECT_EQ(again.json().at("motions").size(), 2u);
}

// Both motions of the file, one set of helpers, one file; caches are one file per motion.
TEST_F(CliRig, AllMotionsGoIntoOneFile) {
  for (const std::string as : {"bones", "morphs"}) {
    const Outcome outcome = run(
        {"bake", "tube.fascia.json", "--motions", "all", "--as", as, "-o", as + ".glb", "--json"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const nlohmann::json answer = outcome.json();
    EXPECT_EQ(answer.at("motions").size(), 2u);
    const nlohmann::json bake = answer.at("bakes").at(0);
    ASSERT_EQ(bake.at("baked").size(), 2u);
    EXPECT_EQ(bake.at("baked").at(0).at("motion"), "bend");
    EXPECT_EQ(bake.at("baked").at(1).at("motion"), "sway");
    EXPECT_TRUE(bake.at("others").empty());
    EXPECT_LT(bake.at("rms_percent"), 2);
  }
  const Outcome cache =
      run({"bake", "tube.fascia.json", "--motion", "sway", "--motion", "bend", "-o", "a.fcache",
           "--as", "cache", "-o", "a.glb", "--stats", "stats.json"});
  ASSERT_EQ(cache.exitCode, 0) << cache.err;
  for (const char* file : {"a.sway.fcache", "a.bend.fcache", "a.sway.glb", "a.sway.pc2",
                           "a.bend.mdd", "stats.sway.json", "stats.bend.json"})
    EXPECT_TRUE(exists(file)) << file;
  EXPECT_FALSE(exists("a.glb"));
}

TEST_F(CliRig, MotionsNotBakedAreMeasured) {
  const Outcome outcome = run(
      {"bake", "tube.fascia.json", "--motion", "bend", "--helpers", "3", "-o", "a.glb", "--json"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const nlohmann::json others = outcome.json().at("bakes").at(0).at("others");
  ASSERT_EQ(others.size(), 1u);
  EXPECT_EQ(others.at(0).at("motion"), "sway");
  EXPECT_LT(others.at(0).at("max_percent"), 2);
}

// The tube bends and comes back: a cycle, whose skin ends where it begins.
TEST_F(CliRig, CyclesCloseUnlessToldNotTo) {
  const auto gap = [&](const char* loop) {
    const Outcome outcome =
        run({"bake", "tube.fascia.json", "--motion", "bend", "--loop", loop, "-o", "a.fcache"});
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    const fascia::Recording recording =
        fascia::readCache((folder_ / "a.fcache").string()).recording;
    EXPECT_EQ(recording.frames.size(), 31u);
    EXPECT_NEAR(recording.frames.front().time_s, 0, 1e-9);
    EXPECT_NEAR(recording.frames.back().time_s, 0.5, 1e-6);
    float largest = 0;
    for (std::size_t v = 0; v < recording.skin.positions.size(); ++v)
      largest = std::max(
          largest, (recording.frames.front().skin_m[v] - recording.frames.back().skin_m[v]).norm());
    return largest;
  };
  EXPECT_GT(gap("off"), 1e-4f);  // of 1 m
  EXPECT_LT(gap("auto"), 1e-5f);
  EXPECT_LT(gap("on"), 1e-5f);
}

TEST_F(CliRig, WhatCannotLoopIsRefused) {
  write("nod.bvh", smallBvh());  // ends bent
  write("pairs.txt", "Root = lower\nTip = upper\n");
  const Outcome nod = run({"bake", "tube.fascia.json", "--motion", "nod.bvh", "--joint-map",
                           "pairs.txt", "--loop", "on", "-o", "a.fcache"});
  EXPECT_EQ(nod.exitCode, 1);
  EXPECT_THAT(nod.err, HasSubstr("does not end as it begins"));
  const Outcome cut =
      run({"bake", "tube.fascia.json", "--loop", "on", "--duration", "0.2", "-o", "a.fcache"});
  EXPECT_EQ(cut.exitCode, 1);
  EXPECT_THAT(cut.err, HasSubstr("--duration"));
  const Outcome twice =
      run({"bake", "tube.fascia.json", "--motion", "bend", "--motion", "bend", "-o", "a.glb"});
  EXPECT_EQ(twice.exitCode, 1);
  EXPECT_THAT(twice.err, HasSubstr("named twice"));
  EXPECT_FALSE(exists("a.fcache"));
  EXPECT_FALSE(exists("a.glb"));
}

// What a bake must not write, and the file that the message names.
TEST_F(CliRig, BakeNeverWritesOverWhatItReadsNorTwice) {
  const std::string rig = content("tube.gltf"), character = content("tube.fascia.json");
  write("nod.bvh", smallBvh());
  const std::vector<std::vector<std::string>> refused{
      {"-o", "a.glb", "-o", "./a.glb"},
      {"--as", "cache", "-o", "a.glb", "-o", "a.pc2"},
      {"-o", "a.fcache", "--stats", "a.fcache"},
      {"-o", "a.fcache", "--stats", "tube.gltf"},
      {"-o", "a.fcache", "--stats", "tube.fascia.json"}};
  for (const std::vector<std::string>& options : refused) {
    std::vector<std::string> command{"bake", "tube.fascia.json"};
    command.insert(command.end(), options.begin(), options.end());
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exitCode, 1) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr("choose another name"));
    for (const char* file : {"a.glb", "a.pc2", "a.fcache"}) EXPECT_FALSE(exists(file)) << file;
  }
  EXPECT_EQ(content("tube.gltf"), rig);
  EXPECT_EQ(content("tube.fascia.json"), character);
}

TEST_F(CliRig, OptionsThatWouldDoNothingAreRefused) {
  const std::vector<std::vector<std::string>> refused{
      {"--as", "morphs", "--helpers", "3", "-o", "a.glb"},
      {"--targets", "3", "-o", "a.glb"},
      {"--as", "cache", "-o", "a.pc2"},
      {"--joint-map", "tube.gltf", "-o", "a.glb"}};
  for (const std::vector<std::string>& options : refused) {
    std::vector<std::string> command{"bake", "tube.fascia.json"};
    command.insert(command.end(), options.begin(), options.end());
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exitCode, 1) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(options[0] == "--as" ? "--" : options[0]));
    EXPECT_FALSE(exists("a.glb"));
  }
}

TEST_F(CliRig, MotionCaptureNeedsAMapWhereNamesSayNothing) {
  write("nod.bvh", smallBvh());
  write("pairs.txt", "Root = lower\nTip = upper\n");
  const Outcome mapped = run({"bake", "tube.fascia.json", "--motion", "nod.bvh", "--joint-map",
                              "pairs.txt", "-o", "a.fcache", "--verbose"});
  ASSERT_EQ(mapped.exitCode, 0) << mapped.err;
  EXPECT_THAT(mapped.out, HasSubstr("drives 2 of the rig's 2"));
  EXPECT_THAT(mapped.out, HasSubstr("Tip = upper"));
  EXPECT_EQ(fascia::readCache((folder_ / "a.fcache").string()).recording.motion, "nod");
  write("wrong.txt", "Root = lower\nTip = uper\n");
  const Outcome wrong = run({"bake", "tube.fascia.json", "--motion", "nod.bvh", "--joint-map",
                             "wrong.txt", "-o", "b.fcache"});
  EXPECT_EQ(wrong.exitCode, 1);
  EXPECT_THAT(wrong.err, HasSubstr("uper"));
  EXPECT_FALSE(exists("b.fcache"));
}

TEST_F(CliRig, InfoShowsAJointMapToEdit) {
  write("nod.bvh", smallBvh());
  write("pairs.txt", "Root = lower\nTip = upper\n");
  const Outcome outcome =
      run({"info", "tube.gltf", "--motion", "nod.bvh", "--joint-map", "pairs.txt"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("Tip = upper"));
}

TEST_F(CliRig, MotionCaptureNeedsARig) {
  write("nod.bvh", smallBvh());
  const Outcome outcome = run({"bake", "ball.fascia.json", "--motion", "nod.bvh", "-o", "a.pc2"});
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_THAT(outcome.err, HasSubstr("needs a character with a rig"));
}

}  // namespace
