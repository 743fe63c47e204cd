#include <gtest/gtest.h>

#include "scripts.h"

// Scripts that try to get out, or never to come back.

namespace fascia {
namespace {

using test::issueOf;
using test::logOf;
using test::Play;

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

TEST(Sandbox, HasNothingThatReachesOut) {
  for (const char* name :
       {"io",       "os",     "package",   "require",        "load",         "loadstring",
        "loadfile", "dofile", "debug",     "collectgarbage", "setmetatable", "getmetatable",
        "pcall",    "xpcall", "coroutine", "rawset",         "rawget",       "next",
        "print",    "warn",   "_G",        "utf8",           "jit",          "module"})
    EXPECT_EQ(logOf("log(" + std::string(name) + ")"), "nil") << name;
  for (const char* name :
       {"string.dump", "string.gsub", "string.gmatch", "string.match", "string.find", "string.pack",
        "string.unpack", "table.move", "math.random", "math.randomseed", "('').dump", "('').find"})
    EXPECT_EQ(logOf("log(" + std::string(name) + ")"), "nil") << name;
}

TEST(Sandbox, HasNoOtherGlobalsThanThoseMeant) {
  EXPECT_EQ(
      logOf(R"(
    local names = {}
    for name in pairs(_ENV) do names[#names + 1] = name end
    log(table.concat(names, " "))
  )"),
      "assert cancel chase connect connected distance error fail follow grab gravity hold impulse "
      "ipairs log math move pairs parallel position pull push random rawequal rawlen release "
      "running select start stop string succeed table time tonumber tostring type vec "
      "velocity wait wait_for");
}

TEST(Sandbox, ReadsNoBytecode) {
  const Issue issue = issueOf("\x1bLuaS");
  EXPECT_NE(issue.message.find("binary chunk"), std::string::npos) << issue.message;
}

TEST(Sandbox, ReadsTextWithAByteOrderMark) {
  EXPECT_EQ(logOf("\xef\xbb\xbflog('read')"), "read");
}

// Each update is within its limit, but there is no end of them.
TEST(Sandbox, StopsARunThatTakesTooMuchInAll) {
  ScriptLimits limits;
  limits.instructions = 200'000;
  const Issue issue = issueOf("while true do for i = 1, 10000 do end wait(0.001) end", limits);
  EXPECT_NE(issue.message.find("200000 instructions in all"), std::string::npos) << issue.message;
  EXPECT_EQ(issueOf("while true do for i = 1, 10000 do end wait(0.5) end", limits).message, "");
}

TEST(Sandbox, StopsLoopsThatNeverWait) {
  const char* const loops[] = {
      "while true do end",
      "for i = 1, math.maxinteger do end",
      "repeat until false",
      "::again:: goto again",
      "local function f() return f() end f()",
      "while true do local s = ('x'):rep(100) end",
      "while true do log(1) end",
      "while true do time() end",
      "while true do hold('left 0') end",
      "while true do connect('left 0', 'right 1') release('left 0') end",
      "while true do impulse('left 0', {1, 0}) end",
      "wait_for(function() while true do end end)",
      "while true do wait_for(function() return true end) end",
      "while true do parallel() end",
      "while true do parallel(function() end) end",
      "local function f() start(f) end f()",
      "local function f() parallel(f) end f()",
      "local function f() parallel(f, f) end f()",
      "table.sort({3, 2, 1}, function() while true do end end)",
      "while true do local t = {} for i = 1, 1000 do t[i] = i end table.sort(t) end",
      "local t = {} for i = 1, 60000 do t[i] = '' end while true do table.concat(t) end",
      "local t = {} for i = 1, 60000 do t[i] = i end while true do table.insert(t, 1, 0) "
      "table.remove(t, 1) end",
      "local t = {} for i = 1, 60000 do t['k' .. i] = i end while true do pairs(t) end",
      "local a = ('x'):rep(1000000) local b = ('x'):rep(999999) .. 'y' while true do local c = a < "
      "b end",
      "while true do tonumber(('1'):rep(1000000)) end",
      "while true do string.format('%99.99f', 1e308) end",
      "while true do tostring(vec(1, 2)) end",
      // The length of such a table is 2^62.
      "local t = {} for k = 0, 62 do t[1 << k] = 1 end t[5] = 1 t[9] = 1 table.insert(t, 1, 0)",
      "local t = {} for k = 0, 62 do t[1 << k] = 1 end t[5] = 1 t[9] = 1 table.remove(t, 1)",
      "local t = {} for k = 0, 62 do t[1 << k] = 1 end t[5] = 1 t[9] = 1 table.sort(t)",
      "local t = {} for k = 0, 62 do t[1 << k] = 1 end t[5] = 1 t[9] = 1 follow('left 0', t)",
      "local t = {} for k = 0, 62 do t[1 << k] = 1 end t[5] = 1 t[9] = 1 table.unpack(t)",
      "local t = {} for k = 0, 62 do t[1 << k] = 1 end t[5] = 1 t[9] = 1 for i = 1, #t do end",
      "local t = {} for k = 0, 62 do t[1 << k] = 1 end t[5] = 1 t[9] = 1 table.concat(t)",
  };
  for (const char* text : loops) {
    const Issue issue = issueOf(text, {.instructions_per_update = 300000, .wall_clock_s = 0.05});
    EXPECT_NE(issue.message, "") << text;
    EXPECT_EQ(issue.where.line, 1) << text;
  }
  EXPECT_EQ(issueOf("\nwhile true do end").message,
            "ran on for more than 1000000 instructions without waiting");
  EXPECT_EQ(issueOf("\nwhile true do end").where.line, 2);
}

TEST(Sandbox, StopsScriptsThatNeedMuchMemory) {
  const char* const hogs[] = {
      "local s = 'x' while true do s = s .. s end",
      "local t = {} while true do t[#t + 1] = {} end",
      "local t = {} while true do t = {t} end",
      "local t = {} for i = 1, 1e9 do t['k' .. i] = ('x'):rep(1000) .. i end",
      "string.rep('x', 1e9)",
      "string.rep('x', 2^62)",
      "string.rep('x', 1e5, ('y'):rep(1e5))",
      "local function f(n) return f(n + 1) + 1 end f(1)",
      "local function f() f() wait(1) end f()",
      "table.unpack({}, 1, 1e7)",
      "string.byte(('x'):rep(1e6), 1, -1)",
      "local t = {} for i = 1, 2000 do t[i] = ('x'):rep(1e6) .. i end",
      "local t = {} for i = 1, 1e9 do t[i] = function() return i end end",
      "local t = {} for i = 1, 1e9 do t[i] = vec(i, i) end",
      "local s = ('x'):rep(1e6) while true do local t = s .. 'y' end",
      "local s = ('x'):rep(1e6) while true do s:upper() end",
  };
  for (const char* text : hogs) {
    const Issue issue = issueOf(text, {.memory_bytes = 2u << 20});
    EXPECT_NE(issue.message, "") << text;
    EXPECT_EQ(issue.where.line, 1) << text << issue.message;
  }
  EXPECT_EQ(issueOf("local t for i = 1, 1e9 do t = {t, ('x'):rep(100) .. i} end").message,
            "needs more than 16 MB of memory");
}

TEST(Sandbox, ReturnsAtOnceFromWhatWouldRunForeverInC) {
  EXPECT_EQ(logOf("log(#string.rep('', 2^53), #string.rep('', 1e9, ''))"), "0 0");
}

TEST(Sandbox, RefusesSourcesThatExhaustTheParser) {
  const std::string nested[] = {"return " + std::string(100000, '('),
                                "return " + std::string(100000, '{'),
                                "return " + repeated("- ", 100000) + "1",
                                "x = " + std::string(100000, '['),
                                std::string(3 << 20, 'x'),
                                "local s = '" + std::string(3 << 20, 'x') + "'"};
  for (const std::string& text : nested) EXPECT_NE(issueOf(text).message, "") << text.substr(0, 20);
  std::string locals = "local x";
  for (int i = 0; i < 300; ++i) locals += ", x" + std::to_string(i);
  EXPECT_NE(issueOf(locals).message, "");
}

TEST(Sandbox, GivesNoAddressAway) {
  EXPECT_EQ(logOf("log(tostring({}), tostring(log), tostring(start(function() end)))"),
            "table function userdata");
  EXPECT_EQ(logOf("log(string.format('%s %s', {}, log))"), "table function");
  for (const char* text : {"string.format('%p', {})", "string.format('%-10p', {})",
                           "string.format('%%%p', {})", "('%p'):format('')"})
    EXPECT_NE(issueOf(text).message, "") << text;
  EXPECT_NE(issueOf("for k in pairs({[{}] = 1}) do end").message, "");
}

TEST(Sandbox, LimitsTasksTiesAndLines) {
  ScriptLimits limits;
  limits.tasks = 10, limits.ties = 3, limits.log_lines = 2;
  EXPECT_NE(issueOf("for i = 1, 20 do start(function() wait(1) end) end", limits).message, "");
  EXPECT_EQ(issueOf("for i = 1, 9 do start(function() wait(1) end) end", limits).message, "");
  EXPECT_NE(issueOf("for i = 1, 4 do push('left 0', {1, 0}, 1) end", limits).message, "");
  EXPECT_EQ(issueOf("for i = 1, 3 do push('left 0', {1, 0}, 1) end", limits).message, "");
  Play play("for i = 1, 9 do log(('x'):rep(5000)) end", 1, limits);
  play.run();
  ASSERT_EQ(play.script.log().size(), 3u);
  EXPECT_LT(play.script.log()[0].text.size(), 1100u);
  EXPECT_EQ(play.script.log()[2].text, "… and more lines");
}

TEST(Sandbox, CutsLongTexts) {
  EXPECT_EQ(logOf("local s = ('x'):rep(1e6) local t = {} for i = 1, 20000 do t[i] = s end "
                  "log(table.unpack(t))")
                .size(),
            1000 + std::string("…").size());
  EXPECT_LT(issueOf("error(('x'):rep(1e6))").message.size(), 1100u);
  EXPECT_LT(issueOf("hold(('x'):rep(1e6))").message.size(), 300u);
}

TEST(Sandbox, SurvivesScriptsThatBreakTheirOwnLibrary) {
  EXPECT_EQ(logOf("tostring = nil log('still')"), "still");
  EXPECT_NE(issueOf("tostring = function() return 1, 2 end math = nil math.sin(1)").message, "");
  EXPECT_EQ(logOf("string.rep = nil _ENV = {log = log} log('x')"), "x");
  EXPECT_NE(issueOf("_ENV = nil log('x')").message, "");
  EXPECT_NE(issueOf("local x <close> = {}").message, "");
  EXPECT_EQ(logOf("local x <close> = nil log('x')"), "x");
}

TEST(Sandbox, IsUsedAgainAfterManyTasks) {
  Play play(
      "for i = 1, 5000 do start(function() wait(0) end) if i % 500 == 0 then wait(0.1) end end "
      "log('through')");
  play.run(20, 0.05);
  EXPECT_EQ(play.log(), "through");
}

TEST(Sandbox, NeedsSomeMemoryToStart) {
  for (std::size_t bytes = 0; bytes < 40000; bytes += 500) {
    ScriptLimits limits;
    limits.memory_bytes = bytes;
    const Issue issue = issueOf("wait(0.1) log(position('left 0'))", limits);
    EXPECT_TRUE(bytes > 5000 || !issue.message.empty()) << bytes;
  }
}

}  // namespace
}  // namespace fascia
