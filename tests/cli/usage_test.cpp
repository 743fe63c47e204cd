#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "program.h"

namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

TEST_F(Cli, HelpOfEveryCommandTeachesByExample) {
  const std::vector<std::vector<std::string>> commands = {
      {}, {"flesh"}, {"bake"}, {"render"}, {"check"}, {"info"}, {"bench"}, {"bench", "paper"}};
  for (std::vector<std::string> command : commands) {
    command.push_back("--help");
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exitCode, 0) << command[0];
    EXPECT_THAT(outcome.out, HasSubstr("Examples:\n  fascia "));
    EXPECT_THAT(outcome.err, IsEmpty());
  }
}

TEST_F(Cli, BadUsageEndsWithTwoAndSaysWhatIsWrong) {
  struct Case {
    std::vector<std::string> arguments;
    std::string told;
  };
  const std::vector<Case> cases = {
      {{}, "A command is required"},
      {{"boil"}, "boil"},
      {{"bake"}, "FILE"},
      {{"bake", "ball.fascia.json"}, "--output"},
      {{"bake", "ball.fascia.json", "-o", "a.obj"}, ".glb, .pc2, .mdd, .fcache"},
      {{"bake", "ball.fascia.json", "-o", "a.glb", "--grid", "64"}, "WIDTHxHEIGHT"},
      {{"bake", "ball.fascia.json", "-o", "a.glb", "--grid", "64x16x2"}, "WIDTHxHEIGHT"},
      {{"bake", "ball.fascia.json", "-o", "a.glb", "--grid", "4x16"}, "[8, 4096]"},
      {{"bake", "ball.fascia.json", "-o", "a.glb", "--fps", "0"}, "--fps"},
      {{"bake", "ball.fascia.json", "-o", "a.glb", "--as", "magic"}, "bones"},
      {{"bake", "ball.fascia.json", "-o", "a.glb", "--influences", "5"}, "--influences"},
      {{"bake", "ball.fascia.json", "-o", "a.glb", "--helpers", "-1"}, "--helpers"},
      {{"bake", "ball.fascia.json", "-o", "a.glb", "--integrator", "magic"}, "verlet"},
      {{"bake", "ball.fascia.json", "-o", "a.glb", "--threads", "-1"}, "--threads"},
      {{"render", "ball.fascia.json", "-o", "a.gif"}, ".png, .mp4"},
      {{"render", "ball.fascia.json", "-o", "a.png", "--camera", "moon"}, "moon"},
      {{"render", "ball.fascia.json", "-o", "a.png", "--layers", "aura"}, "aura"},
      {{"render", "ball.fascia.json", "-o", "a.png", "--size", "0x5"}, "WIDTHxHEIGHT"},
  };
  for (const Case& c : cases) {
    const Outcome outcome = run(c.arguments);
    EXPECT_EQ(outcome.exitCode, 2) << testing::PrintToString(c.arguments);
    EXPECT_THAT(outcome.err, HasSubstr(c.told));
    EXPECT_THAT(outcome.out, IsEmpty());
  }
  EXPECT_EQ(files(), std::vector<std::string>{"ball.fascia.json"});
}

TEST_F(Cli, MissingFilesEndWithOneAndALine) {
  for (const char* command : {"check", "info"}) {
    const Outcome outcome = run({command, "nowhere.fascia.json"});
    EXPECT_EQ(outcome.exitCode, 1);
    EXPECT_THAT(outcome.err, HasSubstr("nowhere.fascia.json"));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
  EXPECT_EQ(run({"bake", "nowhere.fascia.json", "-o", "a.glb"}).exitCode, 1);
  EXPECT_EQ(run({"render", "nowhere.fcache", "-o", "a.png"}).exitCode, 1);
  EXPECT_EQ(run({"bake", ".", "-o", "a.glb"}).exitCode, 1);
}

TEST_F(Cli, CheckAcceptsARightFile) {
  const Outcome outcome = run({"check", "ball.fascia.json"});
  EXPECT_EQ(outcome.exitCode, 0);
  EXPECT_THAT(outcome.out, StartsWith("ball.fascia.json: ok\n"));
  EXPECT_THAT(outcome.err, IsEmpty());
}

// ball.fascia.json with three faults, on lines 5, 8 and 13.
std::string threeFaults(std::string text) {
  const auto replace = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("\"dofs\"", "\"doffs\"");
  replace("\"radius_m\": 0.2", "\"radius_m\": -0.2");
  replace("[0, 1, 0]", "\"up\"");
  return text;
}

TEST_F(Cli, CheckListsEveryFaultWithFileAndLine) {
  write("bad.fascia.json", threeFaults(content("ball.fascia.json")));
  const Outcome outcome = run({"check", "bad.fascia.json"});
  EXPECT_EQ(outcome.exitCode, 1);
  for (const char* place : {"bad.fascia.json:5: /skeleton/0/doffs", "bad.fascia.json:8: /solids/0/",
                            "bad.fascia.json:13: /skin/top/axis"})
    EXPECT_THAT(outcome.err, HasSubstr(place));
}

TEST_F(Cli, CheckTellsMachinesTheSame) {
  write("bad.fascia.json", threeFaults(content("ball.fascia.json")));
  const Outcome outcome = run({"check", "--json", "ball.fascia.json", "bad.fascia.json"});
  EXPECT_EQ(outcome.exitCode, 1);
  const nlohmann::json answer = outcome.json();
  EXPECT_EQ(answer.at("ok"), false);
  ASSERT_GE(answer.at("issues").size(), 3u);
  for (const nlohmann::json& issue : answer.at("issues")) {
    EXPECT_EQ(issue.at("file"), "bad.fascia.json");
    EXPECT_GT(issue.at("line"), 0);
    EXPECT_EQ(issue.at("pointer").get<std::string>().front(), '/');
    EXPECT_FALSE(issue.at("message").get<std::string>().empty());
  }
}

TEST_F(Cli, UnknownMotionNamesThoseThereAre) {
  const Outcome outcome = run({"bake", "ball.fascia.json", "--motion", "fly", "-o", "a.glb"});
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_THAT(outcome.err, HasSubstr("hop, rest"));
}

TEST_F(Cli, InfoDescribesCharacterAndProgram) {
  const nlohmann::json ball = run({"info", "ball.fascia.json", "--json"}).json();
  EXPECT_EQ(ball.at("name"), "ball");
  EXPECT_EQ(ball.at("skin_points"), 16 * 12);
  EXPECT_EQ(ball.at("motions").at(0).at("name"), "hop");
  EXPECT_EQ(ball.at("motions").at(0).at("duration_s"), 0.5);
  const nlohmann::json program = run({"info", "--json"}).json();
  EXPECT_GT(program.at("threads"), 0);
  EXPECT_FALSE(program.at("opengl").get<std::string>().empty());
}

}  // namespace
