#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include <fascia/io/picture/image.h>
#include <nlohmann/json.hpp>

#include "program.h"
#include "rigged.h"

namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

class CliCompare : public Cli {
 protected:
  CliCompare() {
    write("tube.gltf", riggedGltf());
    write("tube.fascia.json", riggedCharacter());
  }

  void needOpenGl() const {
    const std::string opengl = run({"info", "--json"}).json().at("opengl");
    if (opengl.starts_with("none")) GTEST_SKIP() << opengl;
  }

  Outcome compare(const std::string& input, const std::string& output,
                  const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all{"compare", input, "-o", output};
    all.insert(all.end(), more.begin(), more.end());
    return run(all);
  }

  fascia::Image picture(const std::string& file) const {
    return fascia::readImage((folder_ / file).string());
  }

  static bool sameColumns(const fascia::Image& a, const fascia::Image& b, int from, int to,
                          int rows) {
    for (int y = 0; y < rows; ++y)
      for (int x = from; x < to; ++x)
        for (int k = 0; k < 3; ++k) {
          const auto at = static_cast<std::size_t>(4 * (y * a.width + x) + k);
          if (a.rgba[at] != b.rgba[at]) return false;
        }
    return true;
  }
};

TEST_F(CliCompare, PictureOfACharacterAndOfItsRigHaveTheSizeAskedFor) {
  ASSERT_NO_FATAL_FAILURE(needOpenGl());
  for (const std::string input : {"tube.fascia.json", "tube.gltf"}) {
    const Outcome outcome = compare(input, "a.png", {"--size", "400x225", "--json"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const fascia::Image image = picture("a.png");
    EXPECT_EQ(image.width, 400);
    EXPECT_EQ(image.height, 225);
    const nlohmann::json answer = outcome.json();
    EXPECT_EQ(answer.at("motion"), "bend");
    EXPECT_EQ(answer.at("plain").at("name"), "linear blending");
    EXPECT_GT(answer.at("apart_m"), 0);
    EXPECT_LT(answer.at("apart_m"), 0.2);  // the tube is 0.2 m thick
  }
}

// The tube bends most in the middle of the motion and is straight at both ends.
TEST_F(CliCompare, WorstMomentIsWhereItBendsMost) {
  ASSERT_NO_FATAL_FAILURE(needOpenGl());
  const Outcome outcome =
      compare("tube.fascia.json", "a.png", {"--size", "200x160", "--zooms", "0", "--json"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_NEAR(outcome.json().at("worst_s"), 0.25, 0.1);
  EXPECT_GT(outcome.json().at("plain").at("stretch_percentile99"), 1.05);
}

// Another plain skinning changes the left half only, beside ours or behind a line.
TEST_F(CliCompare, EachSideShowsItsOwn) {
  ASSERT_NO_FATAL_FAILURE(needOpenGl());
  for (const std::vector<std::string>& way : {std::vector<std::string>{}, {"--wipe"}}) {
    std::vector<std::string> options{
        "--size",  "400x200", "--time",   "0.2",
        "--zooms", "0",       "--camera", "eye=0,0.5,2.5;target=0,0.5,0"};
    options.insert(options.end(), way.begin(), way.end());
    ASSERT_EQ(compare("tube.fascia.json", "a.png", options).exitCode, 0);
    options.insert(options.end(), {"--against", "delta-mush"});
    ASSERT_EQ(compare("tube.fascia.json", "b.png", options).exitCode, 0);
    const fascia::Image a = picture("a.png"), b = picture("b.png");
    EXPECT_FALSE(sameColumns(a, b, 0, 194, 160));
    EXPECT_TRUE(sameColumns(a, b, 206, 400, 160));
  }
}

TEST_F(CliCompare, PictureIsTheSameOnAnyNumberOfThreads) {
  ASSERT_NO_FATAL_FAILURE(needOpenGl());
  for (const std::string threads : {"1", "2"})
    ASSERT_EQ(
        compare("tube.fascia.json", threads + ".png", {"--size", "300x200", "--threads", threads})
            .exitCode,
        0);
  EXPECT_EQ(content("1.png"), content("2.png"));
}

TEST_F(CliCompare, CacheShowsWhatItsCharacterDoes) {
  ASSERT_NO_FATAL_FAILURE(needOpenGl());
  // A comparison shows a motion once, from its start.
  ASSERT_EQ(run({"bake", "tube.fascia.json", "-o", "a.fcache", "--loop", "off"}).exitCode, 0);
  for (const auto& [input, output] :
       {std::pair("tube.fascia.json", "a.png"), {"a.fcache", "b.png"}})
    ASSERT_EQ(compare(input, output, {"--size", "240x180", "--zooms", "1"}).exitCode, 0);
  EXPECT_EQ(content("a.png"), content("b.png"));
}

// Films, with an encoder or without: then as many pictures as there are frames.
TEST_F(CliCompare, FilmsAreWrittenAndWithoutAnEncoderTheirPictures) {
  ASSERT_NO_FATAL_FAILURE(needOpenGl());
  const std::vector<std::string> film{"--size", "240x160", "--seconds", "0.2", "--fps", "20"};
  const Outcome gif = compare("tube.fascia.json", "a.gif", film);
  ASSERT_EQ(gif.exitCode, 0) << gif.err;
  if (exists("a.gif")) {
    EXPECT_THAT(content("a.gif"), StartsWith("GIF89a"));
    EXPECT_FALSE(exists("a.gif.tmp"));
  }
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  std::vector<std::string> turning = film;
  turning.insert(turning.end(), {"--turntable", "--wipe"});
  const Outcome bare = compare("tube.fascia.json", "b.gif", turning);
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(bare.exitCode, 0);
  EXPECT_THAT(bare.err, HasSubstr("ffmpeg"));
  EXPECT_FALSE(exists("b.gif"));
  int pictures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "b"))
    pictures += entry.path().extension() == ".png" ? 1 : 0;
  EXPECT_EQ(pictures, 4);
}

TEST_F(CliCompare, InterruptedFilmLeavesNothingBehind) {
  ASSERT_NO_FATAL_FAILURE(needOpenGl());
  const std::vector<std::string> before = files();
  Process film(folder_,
               {"compare", "tube.fascia.json", "-o", "a.gif", "--size", "1280x720", "--fps", "60"});
  while (film.running() && !film.hasChild())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ASSERT_TRUE(film.running()) << "done before it could be interrupted";
  film.send(SIGINT);
  EXPECT_EQ(film.wait().signal, SIGINT);
  EXPECT_EQ(files(), before);
}

TEST_F(CliCompare, SaysWhatItIsForWhenThereIsNothingToCompare) {
  const Outcome grid = compare("ball.fascia.json", "a.png");
  EXPECT_EQ(grid.exitCode, 1);
  EXPECT_THAT(grid.err, HasSubstr("ball.fascia.json"));
  EXPECT_THAT(grid.err, HasSubstr("a rig's own skinning beside ours"));
  write("scene.fascia.json", R"({"fascia": 1, "kind": "scene"})");
  EXPECT_THAT(compare("scene.fascia.json", "a.png").err, HasSubstr("is a scene"));
  EXPECT_THAT(compare("tube.fascia.json", "a.png", {"--motion", "bent"}).err,
              HasSubstr("did you mean 'bend'?"));
  EXPECT_THAT(compare("tube.fascia.json", "a.png", {"--time", "7"}).err, HasSubstr("ends at"));
  EXPECT_FALSE(exists("a.png"));
}

TEST_F(CliCompare, OptionsThatDoNotGoTogetherAreRefused) {
  EXPECT_EQ(compare("tube.gltf", "a.jpg").exitCode, 2);
  EXPECT_EQ(compare("tube.gltf", "a.png", {"--size", "100x100"}).exitCode, 2);
  EXPECT_EQ(compare("tube.gltf", "a.png", {"--against", "hope"}).exitCode, 2);
  EXPECT_THAT(compare("tube.gltf", "a.png", {"--turntable"}).err, HasSubstr("is of a film"));
  EXPECT_THAT(compare("tube.gltf", "a.mp4", {"--time", "0.1"}).err, HasSubstr("is of a picture"));
  EXPECT_THAT(compare("tube.gltf", "no/a.png").err, HasSubstr("there is no folder"));
  EXPECT_THAT(files(), ElementsAre("ball.fascia.json", "tube.fascia.json", "tube.gltf"));
}

}  // namespace
