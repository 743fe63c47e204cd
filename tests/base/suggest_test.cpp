#include <fascia/base/suggest.h>

#include <gtest/gtest.h>

#include <initializer_list>

namespace fascia {
namespace {

std::string nearest(std::string_view found, std::initializer_list<std::string_view> known) {
  NearestName name(found);
  for (const std::string_view candidate : known) name.offer(candidate);
  return name.best();
}

TEST(NearestName, ForgivesOneSlipOfEachKind) {
  const auto known = {std::string_view("radius_m"), std::string_view("height_m")};
  EXPECT_EQ(nearest("radus_m", known), "radius_m");
  EXPECT_EQ(nearest("radiuss_m", known), "radius_m");
  EXPECT_EQ(nearest("radios_m", known), "radius_m");
  EXPECT_EQ(nearest("raduis_m", known), "radius_m");
}

TEST(NearestName, PrefersTheNearerOfTwo) {
  EXPECT_EQ(nearest("elbow_lift", {"elbow_right", "elbow_left"}), "elbow_left");
}

TEST(NearestName, IsEmptyWhereNothingIsNearAndForEndlessNames) {
  EXPECT_EQ(nearest("knee", {"elbow", "wrist"}), "");
  EXPECT_EQ(nearest(std::string(5000, 'a'), {std::string(5000, 'a')}), "");
  EXPECT_TRUE(NearestName("knee").hint().empty());
}

TEST(Quoted, CutsLongNamesAndHidesControlCharacters) {
  EXPECT_EQ(quotedName("el\nbow\x1b"), "'el?bow?'");
  EXPECT_LT(quotedName(std::string(5000, 'a')).size(), 100);
}

TEST(ShortNumber, ReadsAsAPersonWouldWriteIt) {
  EXPECT_EQ(shortNumber(0.1), "0.1");
  EXPECT_EQ(shortNumber(-3), "-3");
}

}  // namespace
}  // namespace fascia
