#include <gtest/gtest.h>

#include "scripts.h"

namespace fascia {
namespace {

using test::issueOf;
using test::logOf;
using test::Play;
using test::PuppetStage;

TEST(Script, ReadsAsThePapersScript) {
  Play play(R"(
    grab("right 0", "left 1", 0.5, {1, 0})
    log("got it", connected("right 0", "left 1"))
    grab("left 0", "post", 0.5)
    succeed()
  )");
  play.stage.setVelocity(1, Vec3(0.2, 0.3, 0));
  play.run();
  EXPECT_EQ(play.log(), "got it true");
  EXPECT_EQ(play.script.outcome(), ScriptOutcome::succeeded);
  EXPECT_NEAR(play.stage.state.t_s, 1 + PuppetStage::kStep_s, 1e-9);
  EXPECT_LT(play.stage.puppet->distance_m(play.stage["right 0"], play.stage["left 1"]), 1e-9);
  EXPECT_LT(play.stage.puppet->distance_m(play.stage["left 0"], play.stage["post"]), 1e-9);
}

TEST(Script, ChasesWithTheFinalVelocityGivenAndWithoutLosingAStep) {
  Play play(R"(
    assert(chase("right 0", "left 1", 0.5, {1, 2}))
    log(time(), velocity("right 0"), distance("right 0", "left 1") < 1e-9)
  )");
  play.stage.setVelocity(1, Vec3(0.2, 0.3, 0));
  play.run();
  EXPECT_EQ(play.log(), "0.5 (1, 2, 0) true");
}

TEST(Script, MovesHoldsAndReleases) {
  Play play(R"(
    move("left 0", vec(0.5, 0.5), 0.4)
    wait(0.1)
    log(distance("left 0", {0.5, 0.5}) < 1e-9)
    hold("right 1")
    release("left 0")
    impulse("left 0", {0, 1})
    stop("left 0")
    log(velocity("left 0"):length() < 1e-9)
    move("left 0", "post", 0.3)
    log(distance("left 0", "post") < 1e-9)
  )");
  play.run();
  EXPECT_EQ(play.log(), "true;true;true");
  EXPECT_TRUE(play.stage.puppet->controlled(play.stage["right 1"]));
}

TEST(Script, FollowsKeysByNumberOrName) {
  Play play(R"(
    follow("left 0", {{0, {0, 1}}, {0.25, {0.5, 1}, {1, 0}}, {time = 0.5, at = {1, 0},
           velocity = {0, -1}, velocity_out = {2, 0}}}, {preroll = 0.2})
    log(time(), distance("left 0", {1, 0}) < 1e-9, velocity("left 0"))
    follow("left 0", {{0, {1.5, 0}}, {0.25, {1.5, 0.5}}}, {preroll = 0.1, onset = 1})
    log(time(), distance("left 0", {1.5, 0.5}) < 1e-9)
  )");
  play.run(5, 0.05);
  EXPECT_EQ(play.log(), "0.7 true (2, 0, 0);1.25 true");
}

TEST(Script, PushesAndPullsWithoutWaiting) {
  Play play(R"(
    push("middle 0", {0, 2}, 0.25)
    pull("middle 1", {1, 1}, 50, 20)
    log(time())
    wait(2)
    log(distance("middle 1", {1, 1}) < 0.01)
    pull("middle 1", "left 0", 50)
  )");
  play.run();
  EXPECT_EQ(play.log(), "0.0;true");
  EXPECT_GT(play.stage.velocity("middle 0").y(), 0.05);
}

TEST(Script, ConnectsAndDisconnects) {
  EXPECT_EQ(logOf(R"(
    connect("right 0", "left 1")
    log(connected("left 1", "right 0"))
    release("left 1", "right 0")
    log(connected("left 1", "right 0"))
    connect("right 0", "left 1")
    release("right 0")
    log(connected("left 1", "right 0"))
    connect("right 0", "post")
    log(connected("right 0", "post"))
    release("right 0")
    log(connected("right 0", "post"))
  )"),
            "true;false;false;true;false");
}

TEST(Script, WaitsForTimeAndConditions) {
  EXPECT_EQ(logOf(R"(
    wait(0.5)
    log(math.floor(time() * 60 + 0.5))
    log(wait_for(function() return time() > 0.99 end), math.floor(time() * 60 + 0.5))
    log(wait_for(function() return false end, 0.5), math.floor(time() * 60 + 0.5))
    wait(0)
    log(math.floor(time() * 60 + 0.5))
  )"),
            "30;true 60;false 90;91");
}

TEST(Script, RunsFunctionsAtOnceInTheirOrder) {
  EXPECT_EQ(logOf(R"(
    parallel(function() log("a") wait(0.2) log("b") end,
             function() log("c") wait(0.1) log("d") end,
             function() log("e") wait(0.2) log("f") end)
    log("g", math.floor(time() * 60 + 0.5))
    parallel()
    log("h", math.floor(time() * 60 + 0.5))
  )"),
            "a;c;e;d;b;f;g 12;h 12");
}

TEST(Script, StartsAndCancelsTasks) {
  Play play(R"(
    local task = start(function() parallel(function() move("left 0", {3, 0}, 2) end) log("no") end)
    local other = start(function() wait(0.2) log("other") end)
    wait(0.1)
    log(running(task), running(other))
    cancel(task)
    log(running(task))
    wait(0.2)
    log(running(other))
    local me
    me = start(function() wait(0) cancel(me) log("not after that") end)
  )");
  play.run(0.11);
  EXPECT_FALSE(play.stage.puppet->controlled(play.stage["left 0"]));
  play.run();
  EXPECT_EQ(play.log(), "true true;false;other;false");
  EXPECT_TRUE(play.script.finished());
  EXPECT_EQ(play.script.outcome(), ScriptOutcome::none);
}

TEST(Script, TellsWhetherABehaviourWasOverruled) {
  EXPECT_EQ(logOf(R"(
    start(function() log(move("left 0", {1, 1}, 1)) end)
    wait(0.2)
    hold("left 0")
  )"),
            "false");
}

TEST(Script, EndsAllTasksWithItsOutcome) {
  Play play(R"(
    start(function() move("left 0", {3, 0}, 2) end)
    wait(0.1)
    fail("too far")
    log("not after that")
  )");
  play.run();
  EXPECT_EQ(play.script.outcome(), ScriptOutcome::failed);
  EXPECT_EQ(play.script.reason(), "too far");
  EXPECT_EQ(play.log(), "");
  EXPECT_FALSE(play.stage.puppet->controlled(play.stage["left 0"]));
}

TEST(Script, CalculatesWithVectors) {
  EXPECT_EQ(logOf(R"(
    local a, b = vec(1, 2, 3), vec(0, 1)
    log(a + b, a - b, 2 * a, a * 2, a / 2, -a, a == vec(1, 2, 3), a == b)
    log(a:dot(b), b:cross(a), vec(3, 4):length(), vec(0, 0, 2):normalized(), a.x, a.y, a.z)
    log(a + {1, 1}, {1, 1, 1} - a)
  )"),
            "(1, 3, 3) (1, 1, 3) (2, 4, 6) (2, 4, 6) (0.5, 1, 1.5) (-1, -2, -3) true false;"
            "2.0 (3, 0, -1) 5.0 (0, 0, 1) 1.0 2.0 3.0;(2, 3, 3) (0, -1, -2)");
}

TEST(Script, KnowsThreeDimensions) {
  Play play("move('left 0', {0, 1, 2}, 0.5)", 1, {}, 3);
  play.run();
  EXPECT_LT((play.stage.position("left 0") - Vec3(0, 1, 2)).norm(), 1e-9);
}

TEST(Script, HasSafeLibraries) {
  EXPECT_EQ(logOf(R"(
    log(math.floor(2.7), math.max(1, 3), ("x"):rep(3, "-"), ("Ab"):upper(), #"four")
    log(string.format("%5.2f|%s|%d|%%p", 1.234, vec(1, 2), 3), tostring({}), tostring(nil))
    local t = {c = 1, a = 2, b = 3, [2] = "y", [1] = "x", [true] = 0}
    for k, v in pairs(t) do log(k, v) end
    local list = {5, 3, 4, 1, 2}
    table.sort(list) log(table.concat(list, " "))
    table.sort(list, function(a, b) return a > b end) log(table.concat(list, " "))
    for i, v in ipairs({"p", "q"}) do log(i, v) end
    table.insert(list, 0) table.insert(list, 1, 6) table.insert(list, 8, 9)
    log(table.concat(list, " "), table.remove(list), table.remove(list, 1), table.remove(list, 2),
        table.concat(list, " "), table.remove({}), table.remove({}, 1))
    log(select("#", table.unpack({1, 2})), tonumber("12"), type(log))
  )"),
            "2 3 x-x-x AB 4; 1.23|(1, 2, 0)|3|%p table nil;1 x;2 y;a 2;b 3;c 1;true 0;"
            "1 2 3 4 5;5 4 3 2 1;1 p;2 q;6 5 4 3 2 1 0 9 9 6 4 5 3 2 1 0 nil nil;2 12 function");
}

TEST(Script, SortsStably) {
  EXPECT_EQ(logOf(R"(
    local list = {}
    for i = 1, 37 do list[i] = {key = i * 7 % 5, i = i} end
    table.sort(list, function(a, b) return a.key < b.key end)
    for i = 2, #list do
      local a, b = list[i - 1], list[i]
      assert(a.key < b.key or (a.key == b.key and a.i < b.i))
    end
    log(#list)
  )"),
            "37");
}

// A script that depends on chance, tables and everything that moves.
constexpr const char* kChance = R"(
  local sum = 0
  for key in pairs({one = 1, two = 2, three = 3}) do sum = sum .. key end
  log(sum, tostring(table), random(), random(-1, 1))
  while time() < 1 do
    impulse("middle " .. (random() < 0.5 and 0 or 1), vec(random(-1, 1), random(-1, 1)))
    wait(random(0, 0.1))
  end
)";

TEST(Script, HasTheSameBitsForTheSameSeedOnly) {
  const auto run = [](std::uint64_t seed) {
    Play play(kChance, seed);
    play.run();
    return std::pair(play.stage.state.r, play.log());
  };
  EXPECT_EQ(run(5), run(5));
  EXPECT_NE(run(5).first, run(6).first);
  EXPECT_NE(run(5).second, run(6).second);
}

// Messages.

void expectIssue(const std::string& text, int line, const std::string& message,
                 const std::string& hint = "") {
  const Issue issue = issueOf(text);
  EXPECT_EQ(issue.where.file, issue.message.empty() ? "" : "play.lua");
  EXPECT_EQ(issue.where.line, line) << text;
  EXPECT_EQ(issue.message, message) << text;
  EXPECT_EQ(issue.hint, hint) << text;
}

TEST(ScriptErrors, NameTheCallAndTheLine) {
  expectIssue("log(1)\ngrab('hook.tp', 'left 1', 0.5)", 2,
              "grab(\"hook.tp\", \"left 1\", 0.5): no point is named 'hook.tp'");
  expectIssue("grab('rigt 0', 'left 1', 0.5)", 1,
              "grab(\"rigt 0\", \"left 1\", 0.5): no point is named 'rigt 0'",
              "did you mean 'right 0'?");
  expectIssue("hold('post')", 1, "hold(\"post\"): 'post' is a place, expected a point of a body",
              "only points of bodies can be led, held or pushed");
  expectIssue("connect('left 0', 'left 0')", 1,
              "connect(\"left 0\", \"left 0\"): 'left 0' cannot be connected to itself");
}

TEST(ScriptErrors, CheckArguments) {
  expectIssue("wait(-1)", 1, "wait(-1): seconds: found -1, expected a number in [0, 1e+06]");
  expectIssue("wait(0/0)", 1, "wait(-nan): seconds: found -nan, expected a number in [0, 1e+06]");
  expectIssue("grab('left 0', 'post', 0)", 1,
              "grab(\"left 0\", \"post\", 0): seconds: found 0, expected a number in (0, 1e+06]");
  expectIssue("grab('left 0', 3, 1)", 1,
              "grab(\"left 0\", 3, 1): target: found 3, expected the name of a point or a place "
              "such as {x, y, z}");
  expectIssue("grab('left 0', {1}, 1)", 1,
              "grab(\"left 0\", …, 1): target: found a table of 1 numbers, expected {x, y} or "
              "{x, y, z}");
  expectIssue("impulse('left 0', {1, 'x'})", 1,
              "impulse(\"left 0\", …): impulse[2]: found \"x\", expected a number in [-1e+09, "
              "1e+09]");
  expectIssue("position()", 1, "position(): point: found nothing, expected the name of a point");
  expectIssue("time(1)", 1, "time(1): found 1 arguments, expected 0 at most");
  expectIssue("start(3)", 1, "start(3): task: found 3, expected a function");
  expectIssue("parallel(start, start, 3)", 1,
              "parallel(…, …, 3): functions: found 3, expected a function");
  expectIssue("cancel({})", 1, "cancel(…): task: found a table, expected what start() gave");
  expectIssue("cancel(vec(1, 2))", 1,
              "cancel(…): task: found a userdata, expected what start() gave");
  expectIssue("follow('left 0', {})", 1,
              "follow(\"left 0\", …): path: found no keys, expected one or more");
  expectIssue("follow('left 0', {{0, {0, 0}, speed = 1}})", 1,
              "follow(\"left 0\", …): keys[1]: found the unknown field 'speed'");
  expectIssue("follow('left 0', {{0, {0, 0}}}, {prerol = 1})", 1,
              "follow(\"left 0\", …, …): options: found the unknown field 'prerol'",
              "did you mean 'preroll'?");
  expectIssue("follow('left 0', {{1, {0, 0}}, {0, {1, 0}}})", 1,
              "follow(\"left 0\", …): path: key 2: time: found 0, expected more than the key "
              "before, 1");
  expectIssue("random(2, 1)", 1, "random(2, 1): high: found 1, expected a number in [2, 1e+09]");
}

TEST(ScriptErrors, SuggestFunctions) {
  expectIssue("\n\ngrabb('a', 'b', 1)", 3, "there is no function 'grabb'", "did you mean 'grab'?");
  expectIssue("function reach() end\nreahc()", 2, "there is no function 'reahc'",
              "did you mean 'reach'?");
  expectIssue("math.flor(1)", 1, "there is no function 'flor'", "did you mean 'floor'?");
  expectIssue("log(vec(1, 2):lenght())", 1, "a vec has no field 'lenght', it has x, y and z",
              "did you mean 'length'?");
}

TEST(ScriptErrors, TellWhatLuaSays) {
  expectIssue("log(1)\nlocal x = = 2", 2, "unexpected symbol near '='");
  expectIssue("local x = nil\n\nlog(x.y)", 3, "attempt to index a nil value (local 'x')");
  expectIssue("error('my own')", 1, "my own");
  expectIssue("assert(false, 'no')", 1, "no");
  expectIssue("error({})", 1, "error of type table");
  expectIssue("\nerror()", 2, "error of type nil");
  expectIssue("local v = vec(1, 2) v.x = 3", 1, "the numbers of a vec do not change",
              "make a new one: vec(x, y, z)");
  expectIssue("log(vec(1, 2) + 3)", 1, "vec: found a number, expected a vec");
  expectIssue("table.insert({}, 3, 1)", 1, "bad argument #2 to 'insert' (position out of bounds)");
  expectIssue("table.remove({}, 'x')", 1, "bad argument #2 to 'remove' (position out of bounds)");
  expectIssue("table.sort(3)", 1, "bad argument #1 to 'sort' (table expected)");
}

TEST(ScriptErrors, AreFoundInTasksPredicatesAndComparisons) {
  expectIssue("parallel(function() wait(0.1) end,\n function() wait(0.1)\n hold('x') end)", 3,
              "hold(\"x\"): no point is named 'x'");
  expectIssue("wait_for(function()\n return distance('x', 'post') < 1 end)", 2,
              "distance(\"x\", \"post\"): no point is named 'x'");
  expectIssue("table.sort({1, 2},\n function(a, b) return a.x < b end)", 2,
              "attempt to index a number value (local 'a')");
}

TEST(ScriptErrors, EndTheScriptAndItsControls) {
  Play play("start(function() move('left 0', {3, 0}, 2) end) wait(0.1) nothing()");
  EXPECT_THROW(play.run(), Error);
  EXPECT_TRUE(play.script.finished());
  EXPECT_FALSE(play.stage.puppet->controlled(play.stage["left 0"]));
  EXPECT_NO_THROW(play.step());
}

}  // namespace
}  // namespace fascia
