#include <gtest/gtest.h>

#include "touching_sheets.h"

// What self-contact makes of what it is told of the flesh.

namespace fascia {
namespace {

using test::TwoSheets;

VectorArray normalsOf(const TwoSheets& sheets, double lower, double upper) {
  VectorArray normals(sheets.size());
  for (std::size_t k = 0; k < sheets.size(); ++k)
    test::put(normals, k, Vec3(0, k < sheets.upper ? lower : upper, 0));
  return normals;
}

TEST(SelfContactOnFlesh, PushesNothingOffIt) {
  for (const bool between : {false, true}) {  // the flesh lies between the sheets, or outside
    TwoSheets sheets(0.03);
    sheets.move(sheets.upper, sheets.end, Vec3(0, -0.0295, 0));
    const VectorArray before = sheets.position;
    const double out = between ? -1 : 1;
    const SelfContact::Result result = sheets.contact.separate(
        sheets.points, 0.005f, sheets.position, sheets.velocity,
        static_cast<float>(test::kInterval_s), normalsOf(sheets, out, -out));
    EXPECT_EQ(result.contacts > 0, !between);
    EXPECT_EQ(test::sameBits(sheets.position, before), between);
  }
}

TEST(SelfContactOnFlesh, LaysWhatIsFaceDownFlat) {
  TwoSheets sheets(0.03);
  const VectorArray normals = normalsOf(sheets, 1, -1);
  const VectorArray flat = sheets.position;
  const auto flatten = [&] {
    return sheets.contact.flatten(sheets.points, normals, sheets.position, sheets.velocity);
  };
  EXPECT_EQ(flatten(), 0u);
  EXPECT_TRUE(test::sameBits(sheets.position, flat));
  // One point over its neighbours and beyond.
  sheets.move(66, 67, Vec3(0.025, 0.001, 0));
  EXPECT_GT(flatten(), 0u);
  for (int interval = 0; interval < 20; ++interval) flatten();
  EXPECT_EQ(flatten(), 0u);
  EXPECT_EQ(test::at(sheets.position, sheets.upper + 5), test::at(flat, sheets.upper + 5));
}

}  // namespace
}  // namespace fascia
