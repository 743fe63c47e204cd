#include <gmock/gmock.h>

#include <fstream>

#include <nlohmann/json.hpp>

#include "program.h"
#include "rigged.h"

namespace {

using testing::HasSubstr;

class CliFleshDials : public Cli {
 protected:
  CliFleshDials() { write("tube.gltf", riggedGltf()); }
  nlohmann::json fleshed(std::vector<std::string> more) {
    std::vector<std::string> arguments{"flesh", "tube.gltf", "-o", "tube.fascia.json", "--force"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    std::ifstream file(folder_ / "tube.fascia.json");
    return nlohmann::json::parse(file);
  }
};

TEST_F(CliFleshDials, StandInTheFileWhereTheyDiffer) {
  const auto pose = fleshed(
      {"--jiggle", "0.2", "--muscle", "0.8", "--volume", "1", "--tightness", "0"})["skin"]["pose"];
  EXPECT_EQ(pose["jiggle"], 0.2);
  EXPECT_EQ(pose["muscle"], 0.8);
  EXPECT_EQ(pose["volume"], 1);
  EXPECT_EQ(pose["tightness"], 0);
  EXPECT_FALSE(fleshed({})["skin"].contains("pose"));
}

TEST_F(CliFleshDials, AreFromNoughtToOne) {
  const Outcome outcome = run({"flesh", "tube.gltf", "-o", "tube.fascia.json", "--jiggle", "2"});
  EXPECT_NE(outcome.exitCode, 0);
  EXPECT_THAT(outcome.err, HasSubstr("--jiggle"));
}

TEST_F(CliFleshDials, AreReadBackAndChecked) {
  auto file = fleshed({"--jiggle", "0.2"});
  EXPECT_EQ(run({"check", "tube.fascia.json"}).err, "");
  file["skin"]["pose"]["jiggle"] = -1;
  write("tube.fascia.json", file.dump(2));
  const Outcome outcome = run({"check", "tube.fascia.json"});
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_THAT(outcome.err, HasSubstr("/skin/pose/jiggle"));
}

}  // namespace
