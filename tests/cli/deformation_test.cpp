#include <gmock/gmock.h>

#include <cstdlib>

#include <nlohmann/json.hpp>

#include "program.h"
#include "rigged.h"

namespace {

using nlohmann::json;
using testing::HasSubstr;

class CliDeformation : public Cli {
 protected:
  CliDeformation() {
    write("tube.gltf", riggedGltf());
    write("tube.fascia.json", riggedCharacter());
  }
  Outcome bench(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"bench", "deformation"});
    return run(arguments);
  }
};

std::vector<std::string> textsOf(const json& list, const char* key) {
  std::vector<std::string> texts;
  for (const json& entry : list) texts.push_back(entry.at(key));
  return texts;
}

TEST_F(CliDeformation, MeasuresPosesAndClipsOfEveryContender) {
  const Outcome outcome = bench({"tube.fascia.json", "--motion", "all", "--json"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const json answer = outcome.json();
  EXPECT_EQ(answer.at("ok"), true);
  const json& tube = answer.at("results").at(0);
  EXPECT_THAT(textsOf(tube.at("poses"), "name"), testing::ElementsAre("upper bent by 60°"));
  EXPECT_THAT(textsOf(tube.at("clips"), "motion"), testing::ElementsAre("bend", "sway"));
  for (const char* list : {"poses", "clips"})
    for (const json& stage : tube.at(list)) {
      EXPECT_THAT(
          textsOf(stage.at("results"), "method"),
          testing::IsSupersetOf({"linear blend", "dual quaternions", "delta mush", "fascia"}));
      for (const json& row : stage.at("results")) {
        EXPECT_GT(row.at("stretch_percentile99"), 0.9);
        EXPECT_GE(row.at("lumpiness_rms"), 0);
        EXPECT_GE(row.at("turned_triangles"), 0);
        EXPECT_GT(row.at("point_frame_us"), 0);
      }
    }
  const json& summary = tube.at("summary");
  EXPECT_THAT(textsOf(summary, "method"),
              testing::IsSupersetOf({"dual quaternions", "delta mush", "fascia"}));
  for (const json& row : summary) {
    const json& measures = row.at("measures");
    EXPECT_GT(measures.at("lumpiness_median").at("value"), 0);
    EXPECT_EQ(measures.at("lumpiness_median").contains("goal"),
              row.at("method").get<std::string>().starts_with("fascia"));
  }
}

TEST_F(CliDeformation, BareRigsTakePartWithoutFascia) {
  const Outcome outcome = bench({"tube.gltf", "--motion", "none"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("upper bent by 60°"));
  EXPECT_THAT(outcome.out, HasSubstr("delta mush"));
  EXPECT_THAT(outcome.out, testing::Not(HasSubstr("\nfascia")));
  EXPECT_THAT(outcome.err, HasSubstr("without flesh"));
}

TEST_F(CliDeformation, PutsMotionCaptureOntoTheRigOrSaysWhyNotAndGoesOn) {
  write("nod.bvh", smallBvh());
  const Outcome outcome =
      bench({"tube.gltf", "--poses", "none", "--motion", "nod.bvh", "--motion", "sway"});
  // The tube's joints have no names that a person would know.
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_THAT(outcome.out, HasSubstr("sway, "));
  EXPECT_THAT(outcome.err, HasSubstr("error: "));
}

TEST_F(CliDeformation, WhatIsMissingIsToldAfterTheTables) {
  const Outcome outcome = bench({"nowhere.glb", "tube.gltf", "--motion", "swey", "--json"});
  EXPECT_EQ(outcome.exitCode, 1);
  const json answer = outcome.json();
  EXPECT_EQ(answer.at("ok"), false);
  EXPECT_EQ(answer.at("results").size(), 1u);
  EXPECT_EQ(answer.at("results").at(0).at("poses").size(), 1u);
  ASSERT_EQ(answer.at("issues").size(), 2u);
  EXPECT_EQ(answer.at("issues").at(0).at("file"), "nowhere.glb");
  EXPECT_THAT(outcome.err, HasSubstr("did you mean 'sway'?"));
}

TEST_F(CliDeformation, TablesAreKeptWhereNothingCanBeDrawn) {
  setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere.json", 1);
  setenv("LIBGL_DRIVERS_PATH", "/nowhere", 1);
  const Outcome outcome = bench({"tube.gltf", "--motion", "none", "--pictures", "."});
  unsetenv("__EGL_VENDOR_LIBRARY_FILENAMES");
  unsetenv("LIBGL_DRIVERS_PATH");
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_THAT(outcome.out, HasSubstr("delta mush"));
  EXPECT_THAT(outcome.err, HasSubstr("error: "));
  EXPECT_FALSE(exists("tube-upper-bent-by-60.png"));
}

TEST_F(CliDeformation, UnknownPosesAreBadUsage) {
  EXPECT_EQ(bench({"tube.gltf", "--poses", "yoga"}).exitCode, 2);
}

}  // namespace
