// What somebody tries who has never seen the program: wrong files, and the examples of --help.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "program.h"
#include "rigged.h"
#include "support/assets.h"

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

namespace fs = std::filesystem;

const char* const kFox = "mesh2motion-cc0/fox-animations.glb";
const fs::path kExamples = fs::path(FASCIA_SOURCE_DIR) / "examples";

std::vector<std::string> wordsOf(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

class FirstMinutes : public Cli {
 protected:
  FirstMinutes() { write("tube.gltf", riggedGltf()); }

  void expectRefusal(const std::vector<std::string>& command, const std::string& what,
                     const std::string& advice) const {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exitCode, 1) << testing::PrintToString(command);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(what), HasSubstr(advice), Not(HasSubstr("parse"))))
        << testing::PrintToString(command);
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
};

TEST_F(FirstMinutes, ARigIsToldToBecomeACharacterFirst) {
  ASSERT_EQ(run({"bake", "ball.fascia.json", "--duration", "0.05", "-o", "ball.glb"}).exitCode, 0);
  fs::copy_file(folder_ / "ball.glb", folder_ / "ball.dat");  // by content, whatever the name
  for (const char* file : {"ball.glb", "ball.dat", "tube.gltf"}) {
    for (std::vector<std::string> command : std::vector<std::vector<std::string>>{
             {"bake", file, "-o", "a.glb"}, {"render", file, "-o", "a.png"}, {"check", file}})
      expectRefusal(command, std::string(file) + ": is a 3D model",
                    std::string("fascia flesh ") + file + " -o ");
  }
}

TEST_F(FirstMinutes, OtherFilesAreNamedForWhatTheyAre) {
  write("walk.bvh", "HIERARCHY\nROOT hips\n");
  write("hero.fbx", "Kaydara FBX Binary  ");
  write("hero.dae", "<?xml version=\"1.0\"?><COLLADA></COLLADA>");
  write("skin.png", "\x89PNG\r\n");
  write("empty.fascia.json", "");
  write("reflex.lua", "move(1)");
  const std::vector<std::array<std::string, 3>> cases = {
      {"walk.bvh", "is a motion capture file", "--motion walk.bvh"},
      {"hero.fbx", "is a 3D model", "fascia flesh hero.fbx"},
      {"hero.dae", "is a 3D model", "fascia flesh hero.dae"},
      {"skin.png", "is a picture", "*.fascia.json"},
      {"empty.fascia.json", "is empty", "written to the end"},
      {"reflex.lua", "is a script", "give the scene"},
      {".", "is a folder", "./ball.fascia.json"},
  };
  for (const auto& [file, what, advice] : cases) {
    expectRefusal({"bake", file, "-o", "a.glb"}, what, advice);
    expectRefusal({"render", file, "-o", "a.png"}, what, advice);
    expectRefusal({"check", file}, what, advice);
  }
  expectRefusal({"info", "walk.bvh"}, "is a motion capture file", "--motion walk.bvh");
  expectRefusal({"flesh", "walk.bvh", "-o", "a.fascia.json"}, "is a motion capture file",
                "--motion walk.bvh");
}

TEST_F(FirstMinutes, CharactersScenesAndRecordingsAreNotTakenForEachOther) {
  ASSERT_EQ(run({"bake", "ball.fascia.json", "--duration", "0.05", "-o", "a.fcache"}).exitCode, 0);
  const std::string scene = (kExamples / "sky-hook.fascia.json").string();
  expectRefusal({"bake", "a.fcache", "-o", "a.glb"}, "is a recording",
                "fascia render a.fcache -o a.mp4");
  expectRefusal({"check", "a.fcache"}, "is a recording", "fascia render a.fcache");
  expectRefusal({"flesh", "ball.fascia.json", "-o", "b.fascia.json"}, "is a character",
                "fascia bake ball.fascia.json");
  expectRefusal({"bench", "reflexes", "ball.fascia.json"}, "is a character", "scene");
  expectRefusal({"bench", "scaling", scene}, "is a scene", "fascia render");
  expectRefusal({"compare", scene, "-o", "a.png"}, "is a scene", "fascia render");
}

TEST_F(FirstMinutes, MotionsComeFromFilesThatMove) {
  for (const char* motion : {"walk.obj", "walk.amc", "walk.png"})
    expectRefusal({"bake", "ball.fascia.json", "--motion", motion, "-o", "a.glb"}, motion, ".bvh");
  for (const char* motion : {"walk.bvh", "walk.fbx", "walk.vrma", "walk.glb"})
    expectRefusal({"bake", "ball.fascia.json", "--motion", motion, "-o", "a.glb"}, motion, "a rig");
}

TEST_F(FirstMinutes, OnlyAvatarsBecomeAvatars) {
  expectRefusal({"bake", "ball.fascia.json", "-o", "a.vrm"}, "a.vrm", "name it .glb");
  ASSERT_EQ(run({"flesh", "tube.gltf", "-o", "tube.fascia.json"}).exitCode, 0);
  expectRefusal({"bake", "tube.fascia.json", "-o", "a.vrm"}, "a.vrm", "name it .glb");
}

TEST_F(FirstMinutes, FaultsOfRightFilesAreStillTold) {
  write("bad.fascia.json", "{\"fascia\": 1, \"skeletn\": []}");
  EXPECT_THAT(run({"check", "bad.fascia.json"}).err, HasSubstr("/skeletn"));
  EXPECT_THAT(run({"check", "none.fascia.json"}).err, HasSubstr("none.fascia.json"));
}

// The commands that are shown after one are run as they stand.
TEST_F(FirstMinutes, NextCommandsWorkAndShowALivelyMotion) {
  const auto fox = fascia::assetFile(kFox);
  if (!fox) GTEST_SKIP() << "skipped: no shared assets";
  fs::copy_file(*fox, folder_ / "my fox.glb");
  const Outcome flesh = run({"flesh", "my fox.glb", "-o", "my fox.fascia.json"});
  ASSERT_EQ(flesh.exitCode, 0) << flesh.err;
  EXPECT_THAT(flesh.out, HasSubstr("next: fascia render 'my fox.fascia.json'"));
  EXPECT_THAT(flesh.out, HasSubstr("fascia bake 'my fox.fascia.json' --motion "));
  EXPECT_THAT(flesh.out, Not(HasSubstr("--motion Idle")));
  const Outcome check = run({"check", "my fox.fascia.json"});
  EXPECT_THAT(check.out, HasSubstr("next: fascia render 'my fox.fascia.json' --motion "));
  const Outcome bake = run({"bake", "ball.fascia.json", "--duration", "0.05", "-o", "a.fcache"});
  EXPECT_THAT(bake.out, HasSubstr("next: fascia render a.fcache -o a.mp4\n"));
}

// The lines below "Examples:" of a --help.
std::vector<std::vector<std::string>> examplesIn(const std::string& help) {
  std::istringstream in(help.substr(std::min(help.size(), help.find("Examples:"))));
  std::vector<std::vector<std::string>> examples;
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("  fascia ")) examples.push_back(wordsOf(line));
  return examples;
}

// What the files of a help's examples are: in examples/, or written by an example before.
class Examples : public FirstMinutes {
 protected:
  Examples() { fs::create_directory_symlink(kExamples, folder_ / "examples"); }

  // A word that names a file which is read.
  static bool isInput(const std::vector<std::string>& words, std::size_t i) {
    const std::string& word = words[i];
    if (words[i - 1] == "-o" || words[i - 1] == "--stats" || words[i - 1] == "--pictures")
      return false;
    return word.find(".fascia.json") != std::string::npos || word.ends_with(".glb") ||
           word.ends_with(".fcache") || word.ends_with(".bvh");
  }

  void expectFilesAndMotions(const std::vector<std::string>& words) const {
    std::string file;
    for (std::size_t i = 2; i < words.size(); ++i) {
      if (!isInput(words, i)) continue;
      EXPECT_TRUE(exists(words[i])) << words[i] << ": " << testing::PrintToString(words);
      file = words[i];
    }
    if (file.empty()) return;
    const nlohmann::json info = run({"info", file, "--json"}).json();
    std::set<std::string> motions{"none"};
    for (const nlohmann::json& motion : info.value("motions", nlohmann::json::array()))
      motions.insert(motion.at("name"));
    for (std::size_t i = 2; i < words.size(); ++i) {
      if (words[i - 1] != "--motion") continue;
      EXPECT_TRUE(motions.count(words[i])) << words[i] << ": " << testing::PrintToString(words);
    }
  }

  // The same command where it has less to do; none: it would take too long, and is looked at only.
  static std::vector<std::string> shortened(std::vector<std::string> words) {
    words.erase(words.begin());
    const std::string command = words[0];
    const auto has = [&](const char* option) {
      return std::find(words.begin(), words.end(), option) != words.end();
    };
    if (command == "bench") return {};
    if (command == "compare") {
      if (!has("--seconds")) words.insert(words.end(), {"--seconds", "0.1"});
      const auto size = std::find(words.begin(), words.end(), "--size");
      if (size != words.end()) *(size + 1) = "320x180";
    }
    const bool simulates =
        command == "bake" || (command == "render" && !words[1].ends_with(".fcache"));
    const auto duration = std::find(words.begin(), words.end(), "--duration");
    if (duration != words.end())
      *(duration + 1) = "0.05";
    else if (simulates && !has("--time"))
      words.insert(words.end(), {"--duration", "0.05"});
    if (command == "render" || command == "compare") {
      if (!has("--size")) words.insert(words.end(), {"--size", "320x180"});
    }
    if (command == "flesh") words.emplace_back("--force");
    return words;
  }
};

TEST_F(Examples, OfEveryHelpNameWhatExistsAndRun) {
  const auto fox = fascia::assetFile(kFox);
  if (!fox) GTEST_SKIP() << "skipped: no shared assets";
  fs::copy_file(*fox, folder_ / "fox.glb");
  const std::vector<std::vector<std::string>> commands = {{},
                                                          {"flesh"},
                                                          {"bake"},
                                                          {"render"},
                                                          {"compare"},
                                                          {"check"},
                                                          {"info"},
                                                          {"bench", "paper"},
                                                          {"bench", "scaling"},
                                                          {"bench", "reflexes"},
                                                          {"bench", "deformation"}};
  std::size_t ran = 0;
  for (std::vector<std::string> command : commands) {
    command.emplace_back("--help");
    const std::vector<std::vector<std::string>> examples = examplesIn(run(command).out);
    EXPECT_FALSE(examples.empty()) << testing::PrintToString(command);
    for (const std::vector<std::string>& words : examples) {
      expectFilesAndMotions(words);
      const std::vector<std::string> quick = shortened(words);
      if (quick.empty()) continue;
      const Outcome outcome = run(quick);
      EXPECT_EQ(outcome.exitCode, 0) << testing::PrintToString(words) << outcome.err;
      ++ran;
    }
  }
  EXPECT_GT(ran, 25u);
}

}  // namespace
