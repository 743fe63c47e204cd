#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "program.h"

namespace {

using testing::HasSubstr;

class CliState : public Cli {
 protected:
  std::string hashAfter(std::vector<std::string> options) const {
    options.insert(options.begin(), {"bake", "ball.fascia.json", "--json"});
    const Outcome outcome = run(options);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    return outcome.json().at("stats").at("state_hash");
  }
  void expectRefused(const std::vector<std::string>& command, const std::string& message) const {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.exitCode, 1) << outcome.out;
    EXPECT_THAT(outcome.err, HasSubstr(message));
  }
};

TEST_F(CliState, ARunGoesOnInAnotherProcess) {
  const std::string whole = hashAfter({"--duration", "0.4", "-o", "a.pc2"});
  hashAfter({"--duration", "0.2", "-o", "b.pc2", "--save-state", "b.fstate"});
  EXPECT_EQ(hashAfter({"--from-state", "b.fstate", "--duration", "0.2", "-o", "c.pc2", "--threads",
                       "1", "--save-state", "c.fstate"}),
            whole);
  // To the end of the motion, 0.5 s.
  EXPECT_EQ(hashAfter({"--from-state", "c.fstate", "-o", "d.pc2", "--save-state", "d.fstate"}),
            hashAfter({"-o", "e.pc2"}));
  expectRefused({"bake", "ball.fascia.json", "--from-state", "d.fstate", "-o", "f.pc2"},
                "--duration");
}

TEST_F(CliState, WhatCannotBeIsSaid) {
  hashAfter({"--duration", "0.1", "-o", "a.pc2", "--save-state", "a.fstate"});
  const std::vector<std::string> bake{"bake", "ball.fascia.json", "-o", "b.pc2"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), bake.begin(), bake.end());
    return more;
  };
  expectRefused(with({"--from-state", "a.fstate", "--grid", "24x16"}), "a.fstate: is the state of");
  expectRefused(with({"--from-state", "ball.fascia.json"}), "is not the state of a character");
  expectRefused(with({"--from-state", "none.fstate"}), "none.fstate");
  expectRefused(with({"--save-state", "b.fstate", "--motions", "all"}), "one motion");
  expectRefused(with({"--from-state", "a.fstate", "--save-state", "a.fstate"}), "overwritten");
  expectRefused(with({"--save-state", "b.fstate", "--loop", "on"}), "--save-state");
  write("scene.fascia.json", R"({"fascia": 1, "kind": "scene", "name": "none"})");
  expectRefused({"bake", "scene.fascia.json", "-o", "b.pc2", "--save-state", "b.fstate"},
                "are for characters");
  EXPECT_FALSE(exists("b.pc2") || exists("b.fstate"));
}

TEST_F(CliState, EqualRunsWriteEqualFiles) {
  for (const char* name : {"a", "b"})
    hashAfter({"--duration", "0.2", "-o", std::string(name) + ".fcache", "--save-state",
               std::string(name) + ".fstate"});
  EXPECT_GT(content("a.fcache").size(), 1000u);
  EXPECT_TRUE(content("a.fcache") == content("b.fcache"));
  EXPECT_TRUE(content("a.fstate") == content("b.fstate"));
}

}  // namespace
