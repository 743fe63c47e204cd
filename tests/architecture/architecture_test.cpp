#include <gtest/gtest.h>

#include <fstream>

#include "source_rules.h"

namespace {

namespace fs = std::filesystem;

const fs::path kProject = FASCIA_SOURCE_DIR;

Arrows arrows() {
  return readArrows(kProject / "ARCHITECTURE.md");
}

// A small source tree with one file, and what the rules say about it.
std::vector<std::string> violationsOf(const std::string& path, const std::string& content) {
  const fs::path root =
      fs::path(testing::TempDir()) /
      ("architecture_" +
       std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  fs::remove_all(root);
  fs::create_directories((root / path).parent_path());
  std::ofstream(root / path) << content;
  const std::vector<std::string> found = findViolations(root, arrows());
  fs::remove_all(root);
  return found;
}

TEST(Architecture, TableNamesEveryModuleAndIsFollowedToTheEnd) {
  const Arrows table = arrows();
  for (const fs::directory_entry& entry : fs::directory_iterator(kProject / "src/fascia")) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(!entry.is_directory() || table.contains(name)) << name;
  }
  EXPECT_EQ(table.at("base"), std::set<std::string>{"base"});
  EXPECT_TRUE(table.at("io").contains("base"));
  EXPECT_FALSE(table.at("field").contains("skeleton"));
  EXPECT_FALSE(table.at("render").contains("io"));
}

TEST(Architecture, SourcesFollowIt) {
  for (const std::string& violation : findViolations(kProject / "src/fascia", arrows()))
    ADD_FAILURE() << "src/fascia/" << violation;
}

TEST(Architecture, RefusesAnArrowThatPointsInward) {
  const auto found = violationsOf("field/a.h", "#pragma once\n#include <fascia/skin/skin.h>\n");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0], "field/a.h:2: includes <fascia/skin/skin.h>, but field may not use skin");
}

TEST(Architecture, RefusesTheFacadeBehindItself) {
  const std::string facade = "#include <fascia/fascia.h>\n";
  EXPECT_EQ(violationsOf("io/a.cpp", facade).size(), 1u);
  EXPECT_TRUE(violationsOf("facade/a.cpp", facade).empty());
  EXPECT_TRUE(violationsOf("fascia.h", "#include <fascia/io/a.h>\n").empty());
}

TEST(Architecture, RefusesAnArrowBetweenFoldersThatPointsInward) {
  const std::string solver = "#include <fascia/deformable/solve/body_system.h>\n";
  const auto found = violationsOf("deformable/body/a.h", solver);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0],
            "deformable/body/a.h:1: includes <fascia/deformable/solve/body_system.h>, but "
            "deformable/body may not use deformable/solve");
  EXPECT_TRUE(violationsOf("deformable/puppet/a.h", solver).empty());
}

TEST(Architecture, RefusesAFolderThatTheTableDoesNotName) {
  EXPECT_EQ(violationsOf("deformable/surprise/a.h", "#pragma once\n").size(), 1u);
}

TEST(Architecture, RefusesFilesBelowIo) {
  EXPECT_EQ(violationsOf("skin/a.cpp", "#include <fstream>\n").size(), 1u);
  EXPECT_EQ(violationsOf("render/a.cpp", "auto* f = fopen(p, \"r\");\n").size(), 1u);
  EXPECT_TRUE(violationsOf("io/a.cpp", "#include <fstream>\n").empty());
}

TEST(Architecture, RefusesOpenGlOutsideOfRender) {
  EXPECT_EQ(violationsOf("character/a.cpp", "#include <epoxy/gl.h>\n").size(), 1u);
  EXPECT_EQ(violationsOf("io/a.cpp", "#include <QWidget>\n").size(), 1u);
  EXPECT_TRUE(violationsOf("render/a.cpp", "#include <epoxy/gl.h>\n").empty());
}

TEST(Architecture, RefusesPrintingInModules) {
  EXPECT_EQ(violationsOf("io/a.cpp", "void f() { printf(\"x\"); }\n").size(), 1u);
  EXPECT_EQ(violationsOf("math/a.cpp", "void f() { std::cerr << 1; }\n").size(), 1u);
  EXPECT_TRUE(
      violationsOf("math/a.cpp", "void f() { snprintf(b, n, \"x\"); }  // printf(\n").empty());
}

TEST(Architecture, RefusesAModuleThatTheTableDoesNotName) {
  EXPECT_EQ(violationsOf("surprise/a.h", "#pragma once\n").size(), 1u);
}

}  // namespace
