#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include <Eigen/Core>

#include <fascia/base/assert.h>

namespace fascia {
namespace {

TEST(AssertDeathTest, IsEvaluatedInDebugBuildsOnly) {
  int asked = 0;
  const auto ask = [&] { return ++asked > 0; };
  FASCIA_ASSERT(ask(), "the question is asked");
#ifdef NDEBUG
  EXPECT_EQ(asked, 0);
  FASCIA_ASSERT(false, "nobody asks");
#else
  EXPECT_EQ(asked, 1);
  EXPECT_DEATH(FASCIA_ASSERT(1 + 1 == 3, "sums are sums"), "assert_test.*sums are sums");
#endif
}

TEST(AssertHelpers, TellWhatIsSound) {
  EXPECT_TRUE(areFinite(std::array{1.0, -2.0}));
  EXPECT_FALSE(areFinite(std::array{1.0, std::nan("")}));
  EXPECT_TRUE(areBelow(std::array{0, 1, 2}, 3));
  EXPECT_FALSE(areBelow(std::array{0, 3}, 3));
  EXPECT_FALSE(areBelow(std::array{-1}, 3));
  EXPECT_TRUE(isUnit(Eigen::Vector3d(0, 1, 0)));
  EXPECT_FALSE(isUnit(Eigen::Vector3f(0, 1.1f, 0)));
}

}  // namespace
}  // namespace fascia
