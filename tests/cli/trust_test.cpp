// Nothing that a person has is lost, and what strangers' files hold stays where it is.
#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include <nlohmann/json.hpp>

#include <fascia/io/file/file.h>
#include <fascia/io/picture/image.h>

#include "program.h"
#include "rigged.h"

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

// A character with a texture, one on a rig, a motion and a joint map; and other names of them.
class CliTrust : public Cli {
 protected:
  CliTrust() {
    fascia::writePng({2, 2, std::vector<std::uint8_t>(16, 200)}, (folder_ / "skin.png").string());
    nlohmann::json ball = nlohmann::json::parse(content("ball.fascia.json"));
    ball["skin"]["texture"] = "skin.png";
    write("ball.fascia.json", ball.dump());
    write("tube.gltf", riggedGltf());
    write("tube.fascia.json", riggedCharacter());
    write("small.bvh", smallBvh());
    write("small.map", "Root = lower\nTip = upper\n");
    for (const char* name : {"skin.png", "tube.gltf", "small.bvh", "small.map"}) {
      fs::create_symlink(name, folder_ / ("soft." + std::string(name)));
      fs::create_hard_link(folder_ / name, folder_ / ("hard." + std::string(name)));
    }
    for (const std::string& name : files()) before_.push_back(content(name));
    names_ = files();
  }

  void expectRefused(const std::vector<std::string>& arguments) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 1) << testing::PrintToString(arguments);
    EXPECT_THAT(outcome.err, HasSubstr("would be overwritten"))
        << testing::PrintToString(arguments);
    expectNothingLost();
  }
  void expectNothingLost() {
    ASSERT_EQ(files(), names_);
    for (std::size_t i = 0; i < names_.size(); ++i)
      ASSERT_EQ(content(names_[i]), before_[i]) << names_[i];
  }

  std::vector<std::string> names_, before_;
};

TEST_F(CliTrust, NoOutputIsWhatIsReadForIt) {
  for (const std::string prefix : {"", "soft.", "hard.", "./"}) {
    for (const char* command : {"bake", "render"}) {
      const std::string out = std::string(command) == "bake" ? "a.pc2" : "a.png";
      const auto refused = [&](const std::string& input, const std::string& stats,
                               std::vector<std::string> more = {}) {
        std::vector<std::string> all{command, input, "-o", out, "--stats", prefix + stats};
        all.insert(all.end(), more.begin(), more.end());
        expectRefused(all);
      };
      refused("ball.fascia.json", "skin.png");
      refused("tube.fascia.json", "tube.gltf");
      const std::vector<std::string> mapped{"--motion", "small.bvh", "--joint-map", "small.map"};
      refused("tube.fascia.json", "small.bvh", mapped);
      refused("tube.fascia.json", "small.map", mapped);
    }
    expectRefused({"render", "ball.fascia.json", "-o", prefix + "skin.png"});
    expectRefused({"flesh", "tube.gltf", "-o", "a.fascia.json", "--report", prefix + "tube.gltf"});
  }
}

TEST_F(CliTrust, OtherFilesAreReplacedAndLinksLedThrough) {
  write("a.pc2", "old");
  fs::create_symlink("a.pc2", folder_ / "link.pc2");
  ASSERT_EQ(run({"bake", "ball.fascia.json", "-o", "link.pc2"}).exitCode, 0);
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.pc2"));
  EXPECT_THAT(content("a.pc2"), testing::StartsWith("POINTCACHE2"));
}

TEST_F(CliTrust, SignalsEndEveryCommandAtOnce) {
  for (const int signal : {SIGINT, SIGTERM})
    for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
             {"render", "ball.fascia.json", "--time", "80000", "--size", "32x24", "-o", "a.png"},
             {"bench", "paper", "--seconds", "3000", "--examples", FASCIA_SOURCE_DIR "/examples"},
             {"bake", "ball.fascia.json", "--duration", "80000", "-o", "a.glb"}}) {
      Process process(folder_, command);
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      process.send(signal);
      const Outcome outcome = process.wait();
      EXPECT_EQ(outcome.signal, signal) << command[0] << outcome.err;
      expectNothingLost();
    }
}

TEST_F(CliTrust, OutputThatCannotBeWrittenIsAnError) {
  for (const char* command : {"info ball.fascia.json --json", "info ball.fascia.json", "--version",
                              "--help", "check ball.fascia.json"}) {
    const std::string line = "cd '" + folder_.string() + "' && '" FASCIA_PROGRAM "' " + command;
    EXPECT_EQ(WEXITSTATUS(std::system((line + " >/dev/full 2>err").c_str())), 1) << command;
    EXPECT_THAT(content("err"), HasSubstr("standard output cannot be written: No space left"));
    EXPECT_EQ(WEXITSTATUS(std::system((line + " >&- 2>err").c_str())), 1) << command;
    EXPECT_EQ(WEXITSTATUS(std::system((line + " >/dev/null 2>err").c_str())), 0) << command;
  }
}

TEST_F(CliTrust, OptionsAreNumbers) {
  for (const char* number : {"nan", "-nan", "inf", "-inf", "1e999", "", "1x"}) {
    for (const char* option : {"--fps", "--duration", "--step", "--seed", "--threads"})
      EXPECT_EQ(run({"bake", "ball.fascia.json", "-o", "a.pc2", option, number}).exitCode, 2)
          << option << number;
    EXPECT_EQ(run({"render", "ball.fascia.json", "-o", "a.png", "--time", number}).exitCode, 2);
    EXPECT_EQ(run({"flesh", "tube.gltf", "-o", "a.fascia.json", "--fat", number}).exitCode, 2);
    EXPECT_EQ(run({"flesh", "tube.gltf", "-o", "a.fascia.json", "--scale", number}).exitCode, 2);
    EXPECT_EQ(run({"compare", "tube.gltf", "-o", "a.png", "--seconds", number}).exitCode, 2);
  }
  for (const char* camera : {"az=nan", "el=inf", "dist=nan", "fov=nan", "eye=nan,0,0;target=0,0,0"})
    EXPECT_EQ(run({"render", "ball.fascia.json", "-o", "a.png", "--camera", camera}).exitCode, 2)
        << camera;
  expectNothingLost();
}

TEST_F(CliTrust, NamesMoveNoCursor) {
  nlohmann::json rig = nlohmann::json::parse(riggedGltf());
  rig["materials"] = {{{"name", "a\x1b[2J\nerror: forged\xc2\x9b"}}};
  for (nlohmann::json& mesh : rig["meshes"])
    for (nlohmann::json& primitive : mesh["primitives"]) primitive["material"] = 0;
  for (nlohmann::json& motion : rig["animations"]) motion["name"] = "\x1b]0;title\x07";
  write("odd.gltf", rig.dump());
  const Outcome text = run({"info", "odd.gltf"}), answer = run({"info", "odd.gltf", "--json"});
  const Outcome usage = run({"info", "no\x1b[2J\n.gltf"});
  for (const Outcome* outcome : {&text, &answer, &usage})
    for (const std::string* stream : {&outcome->out, &outcome->err}) {
      EXPECT_THAT(*stream, Not(HasSubstr("\x1b")));
      EXPECT_THAT(*stream, Not(HasSubstr("\xc2\x9b")));
      EXPECT_THAT(*stream, Not(HasSubstr("\nerror: forged")));
    }
  EXPECT_THAT(text.out, HasSubstr("\\x1b[2J\\nerror: forged\\x9b"));
  EXPECT_EQ(answer.json().at("rig_materials").at(0).at("name"), "a\x1b[2J\nerror: forged\xc2\x9b");
}

TEST_F(CliTrust, FaultsNameTheirFiles) {
  const auto told = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 1) << testing::PrintToString(arguments);
    return outcome.err;
  };
  write("bad.map", "\xef\xbb\xbfRoot = lower\nHat = lower\nTip = scarf\n");
  const std::string map =
      told({"info", "tube.gltf", "--motion", "small.bvh", "--joint-map", "bad.map"});
  EXPECT_THAT(map, HasSubstr("bad.map:2: the joint map names 'Hat'"));
  EXPECT_THAT(map, HasSubstr("bad.map:3: the joint map names 'scarf'"));
  EXPECT_THAT(map, Not(HasSubstr(":1:")));
  write("none.map", "Root =\nTip =\n");
  EXPECT_THAT(told({"info", "tube.gltf", "--motion", "small.bvh", "--joint-map", "none.map"}),
              HasSubstr("small.bvh: no joint of the rig is driven"));
  const std::string picture = content("skin.png");
  write("skin.png", picture.substr(0, picture.size() - 20));
  EXPECT_THAT(told({"render", "ball.fascia.json", "-o", "a.png", "--size", "16x16"}),
              HasSubstr("ball.fascia.json: /skin/texture: the texture skin.png: not a good PNG"));
  write("skin.png", "\xff\xd8\xffrubbish");
  EXPECT_THAT(told({"check", "ball.fascia.json"}),
              HasSubstr("/skin/texture: the texture skin.png: not a good JPEG"));
}

}  // namespace
