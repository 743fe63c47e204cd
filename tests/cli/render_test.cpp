#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <thread>

#include <fascia/io/picture/image.h>
#include <nlohmann/json.hpp>

#include "program.h"

namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class CliRender : public Cli {
 protected:
  void SetUp() override {
    const std::string opengl = run({"info", "--json"}).json().at("opengl");
    if (opengl.starts_with("none")) GTEST_SKIP() << opengl;
  }
};

TEST_F(CliRender, PictureHasTheSizeAskedFor) {
  const Outcome outcome =
      run({"render", "ball.fascia.json", "-o", "a.png", "--size", "97x53", "--time", "0.1"});
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  const fascia::Image image = fascia::readImage((folder_ / "a.png").string());
  EXPECT_EQ(image.width, 97);
  EXPECT_EQ(image.height, 53);
}

TEST_F(CliRender, CharacterAndItsCacheGiveTheSamePicture) {
  ASSERT_EQ(run({"bake", "ball.fascia.json", "-o", "a.fcache"}).exitCode, 0);
  const std::vector<std::string> rest = {"--size", "160x120",  "--time",
                                         "0.2",    "--layers", "skeleton,muscle,skin"};
  for (const auto& [from, to] : {std::pair("ball.fascia.json", "a.png"), {"a.fcache", "b.png"}}) {
    std::vector<std::string> arguments = {"render", from, "-o", to};
    arguments.insert(arguments.end(), rest.begin(), rest.end());
    ASSERT_EQ(run(arguments).exitCode, 0);
  }
  EXPECT_EQ(content("a.png"), content("b.png"));
}

TEST_F(CliRender, SimulatesAsBakeDoes) {
  const Outcome baked = run({"bake", "ball.fascia.json", "--json", "-o", "a.fcache"});
  const Outcome rendered =
      run({"render", "ball.fascia.json", "--json", "-o", "a.mp4", "--size", "64x48"});
  ASSERT_EQ(rendered.exitCode, 0) << rendered.err;
  EXPECT_EQ(rendered.json().at("stats").at("state_hash"),
            baked.json().at("stats").at("state_hash"));
}

TEST_F(CliRender, ACacheIsSaidToBeReadNotSimulated) {
  ASSERT_EQ(run({"bake", "ball.fascia.json", "-o", "a.fcache"}).exitCode, 0);
  const Outcome cached = run({"render", "a.fcache", "-o", "a.png", "--size", "32x24"});
  EXPECT_THAT(cached.out, HasSubstr("read from cache a.fcache"));
  EXPECT_THAT(cached.out, Not(HasSubstr("simulated")));
  const Outcome fresh = run({"render", "ball.fascia.json", "-o", "b.png", "--size", "32x24"});
  EXPECT_THAT(fresh.out, HasSubstr("simulated"));
}

TEST_F(CliRender, FastLookIsAnotherPictureOfTheSameSize) {
  for (const char* look : {"full", "fast"})
    ASSERT_EQ(run({"render", "ball.fascia.json", "-o", std::string(look) + ".png", "--size",
                   "160x120", "--look", look})
                  .exitCode,
              0);
  const fascia::Image fast = fascia::readImage((folder_ / "fast.png").string());
  EXPECT_EQ(fast.width, 160);
  EXPECT_EQ(fast.height, 120);
  EXPECT_NE(content("full.png"), content("fast.png"));
  EXPECT_NE(run({"render", "ball.fascia.json", "-o", "a.png", "--look", "slow"}).exitCode, 0);
}

TEST_F(CliRender, WhatIsSoonDoneShowsNoProgress) {
  const Outcome outcome = run({"render", "ball.fascia.json", "-o", "a.png", "--size", "32x24"});
  EXPECT_EQ(outcome.err, "");
}

TEST_F(CliRender, TimeOutsideOfTheCacheIsRefused) {
  ASSERT_EQ(run({"bake", "ball.fascia.json", "-o", "a.fcache"}).exitCode, 0);
  const Outcome outcome = run({"render", "a.fcache", "-o", "a.png", "--time", "7"});
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_FALSE(exists("a.png"));
}

TEST_F(CliRender, InterruptedVideoLeavesNothingBehind) {
  ASSERT_EQ(run({"bake", "ball.fascia.json", "--duration", "20", "-o", "a.fcache"}).exitCode, 0);
  Process render(folder_, {"render", "a.fcache", "-o", "a.mp4", "--size", "640x480"});
  while (render.running() && !render.hasChild())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ASSERT_TRUE(render.running()) << "done before it could be interrupted";
  render.send(SIGINT);
  EXPECT_EQ(render.wait().signal, SIGINT);
  EXPECT_THAT(files(), ElementsAre("a.fcache", "ball.fascia.json"));
}

}  // namespace
