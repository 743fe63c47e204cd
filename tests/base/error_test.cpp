#include <fascia/base/error.h>

#include <gtest/gtest.h>

namespace fascia {
namespace {

TEST(IssueText, NamesFileLinePointerMessageAndHint) {
  const Issue issue{{"penguin.fascia.json", 12, "/skin/grid"}, "found 3", "use 8 or more"};
  EXPECT_EQ(issue.text(), "penguin.fascia.json:12: /skin/grid: found 3 (use 8 or more)");
}

TEST(IssueText, LeavesOutWhatIsUnknown) {
  EXPECT_EQ((Issue{{}, "found 3", {}}.text()), "found 3");
  EXPECT_EQ((Issue{{"a.json", 0, {}}, "found 3", {}}.text()), "a.json: found 3");
  EXPECT_EQ((Issue{{{}, 7, {}}, "found 3", {}}.text()), "line 7: found 3");
  EXPECT_EQ((Issue{{{}, 0, "/a"}, "found 3", {}}.text()), "/a: found 3");
  EXPECT_EQ((Issue{{{}, 7, "/a"}, "found 3", {}}.text()), "line 7: /a: found 3");
}

TEST(Error, ShowsEveryIssueOnItsOwnLine) {
  const Error error({Issue{{}, "first", {}}, Issue{{{}, 0, "/b"}, "second", {}}});
  EXPECT_STREQ(error.what(), "first\n/b: second");
  EXPECT_EQ(error.issues().size(), 2);
}

TEST(Error, OfAPlainMessageIsOneIssueWithoutAPlace) {
  const Error error("cannot open");
  EXPECT_STREQ(error.what(), "cannot open");
  ASSERT_EQ(error.issues().size(), 1);
  EXPECT_TRUE(error.issues()[0].where.file.empty());
}

TEST(Diagnostics, ThrowsEveryErrorAtOnce) {
  Diagnostics diagnostics;
  diagnostics.error("/a", "found 1", "use 2");
  diagnostics.error("/b", "found 3");
  EXPECT_FALSE(diagnostics.ok());
  try {
    diagnostics.throwIfErrors();
    FAIL() << "did not throw";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "/a: found 1 (use 2)\n/b: found 3");
    EXPECT_EQ(error.issues()[1].where.pointer, "/b");
  }
}

TEST(Diagnostics, DoesNotThrowForWarnings) {
  Diagnostics diagnostics;
  diagnostics.warning("/a", "is unusual");
  EXPECT_TRUE(diagnostics.ok());
  EXPECT_NO_THROW(diagnostics.throwIfErrors());
  ASSERT_EQ(diagnostics.warnings().size(), 1);
  EXPECT_EQ(diagnostics.warnings()[0].text(), "/a: is unusual");
}

}  // namespace
}  // namespace fascia
