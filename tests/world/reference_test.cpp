#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include <fascia/world/script_api.h>

#include "scripts.h"

// The files that are made from the description of the functions.

namespace fascia {
namespace {

const std::string kRoot = FASCIA_SOURCE_DIR;
constexpr std::string_view kStart = "<!-- functions -->\n", kEnd = "<!-- end of functions -->";

std::string read(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// The file has to be `wanted`; with FASCIA_UPDATE_SCHEMA it is made so.
void expectFile(const std::string& path, const std::string& wanted) {
  if (std::getenv("FASCIA_UPDATE_SCHEMA")) std::ofstream(path, std::ios::binary) << wanted;
  EXPECT_EQ(read(path), wanted) << "run this test once with FASCIA_UPDATE_SCHEMA=1 to write "
                                << path << " anew";
}

TEST(ScriptReference, PublishedAnnotationsAreThoseOfTheFunctions) {
  expectFile(kRoot + "/schema/fascia-api.lua", scriptAnnotations());
}

TEST(ScriptReference, PublishedPageHasTheTableOfTheFunctions) {
  const std::string path = kRoot + "/docs/scripting.md", page = read(path);
  const std::size_t start = page.find(kStart), end = page.find(kEnd);
  ASSERT_TRUE(start != std::string::npos && end != std::string::npos && start < end);
  expectFile(path, page.substr(0, start + kStart.size()) + scriptReference() + page.substr(end));
}

TEST(ScriptReference, ExamplesOfThePageRun) {
  std::istringstream page(read(kRoot + "/docs/scripting.md"));
  std::string script;
  int count = 0;
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (inside && line == "```") {
      EXPECT_EQ(test::issueOf(script).text(), Issue{}.text()) << script;
      inside = false, ++count;
    } else if (line == "```lua") {
      inside = true, script.clear();
    } else if (inside) {
      script += line + "\n";
    }
  }
  EXPECT_GE(count, 3);
}

TEST(ScriptReference, AnnotationsAreLua) {
  EXPECT_EQ(test::issueOf(scriptAnnotations()).message, "");
}

TEST(ScriptReference, DescribesEveryParameter) {
  std::size_t count = 0;
  for (const ScriptSection& section : scriptSections()) {
    for (const ScriptFunction& function : section.functions) {
      ++count;
      EXPECT_FALSE(function.help.empty()) << function.name;
      EXPECT_EQ(function.resultType.empty(), function.result.empty()) << function.name;
      bool optional = false;
      for (const ScriptParameter& parameter : function.parameters) {
        EXPECT_FALSE(parameter.type.empty()) << function.name;
        EXPECT_TRUE(parameter.optional || !optional) << function.name;
        optional = parameter.optional;
      }
    }
  }
  EXPECT_GT(count, 20u);
}

}  // namespace
}  // namespace fascia
