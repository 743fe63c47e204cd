#include <gtest/gtest.h>

#include <fascia/base/printable.h>

namespace fascia {
namespace {

TEST(Printable, LeavesTextAsItIs) {
  for (const char* text : {"", "fox.glb: is cut short", "Bärenfell · 32 °C … 熊 🦊"})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, ShowsWhatMovesACursor) {
  EXPECT_EQ(printable("a\nb\rc\td"), "a\\nb\\rc\\td");
  EXPECT_EQ(printable("\x1b[2J"), "\\x1b[2J");
  EXPECT_EQ(printable(std::string_view("\0\x7f", 2)), "\\x00\\x7f");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            "\\x9b2J");  // the same in one character
  EXPECT_EQ(printable("\xe2\x80\xae"
                      "gnp.fox"),
            "\\u202egnp.fox");  // from right to left
}

TEST(Printable, ShowsBytesThatAreNoUtf8) {
  EXPECT_EQ(printable("\xff"), "\\xff");
  EXPECT_EQ(printable("\xc3"), "\\xc3");                    // cut short
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b");           // overlong
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");  // half of a pair
}

TEST(Printable, KeepsTheLinesOfJson) {
  EXPECT_EQ(printableJson("{\n  \"a\": \"\x7f\xc2\x9b\"\n}\n"),
            "{\n  \"a\": \"\\u007f\\u009b\"\n}\n");
}

}  // namespace
}  // namespace fascia
