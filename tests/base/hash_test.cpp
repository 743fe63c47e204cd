#include <fascia/base/hash.h>

#include <gtest/gtest.h>

#include <bit>
#include <set>
#include <string_view>
#include <vector>

#include <fascia/base/random.h>

namespace fascia {
namespace {

std::uint64_t hashOf(const void* data, std::size_t bytes) {
  StateHash hash;
  hash.add(data, bytes);
  return hash.value();
}

TEST(StateHash, IsFnv1aForSingleBytes) {
  // The published test vectors of FNV-1a, 64 bits.
  EXPECT_EQ(hashOf("", 0), 0xcbf29ce484222325ull);
  EXPECT_EQ(hashOf("a", 1), 0xaf63dc4c8601ec8cull);
  EXPECT_EQ(hashOf("foobar", 6), 0x85944171f73967e8ull);
}

TEST(StateHash, ChangesWithEverySingleBitOfAState) {
  std::vector<float> state(11);
  Random random(3);
  for (float& x : state) x = static_cast<float>(random.uniform(-1, 1));
  std::set<std::uint64_t> seen{hashOf(state.data(), 44)};
  for (float& x : state) {
    for (int bit = 0; bit < 32; ++bit) {
      const float original = x;
      x = std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) ^ (1u << bit));
      seen.insert(hashOf(state.data(), 44));
      x = original;
    }
  }
  EXPECT_EQ(seen.size(), 1 + 11 * 32);
}

TEST(StateHash, TellsTheOrderOfItsInputs) {
  StateHash ab, ba;
  ab.add(1.0), ab.add(2.0);
  ba.add(2.0), ba.add(1.0);
  EXPECT_NE(ab.value(), ba.value());
}

TEST(StateHash, PrintsSixteenHexadecimalDigits) {
  EXPECT_EQ(StateHash().hex(), "cbf29ce484222325");
}

TEST(Random, RepeatsItsSequenceForASeed) {
  Random a(42), b(42), c(43);
  const std::uint64_t first = a.next();
  EXPECT_EQ(first, b.next());
  EXPECT_NE(first, c.next());
  EXPECT_EQ(Random(0).next(), 0xe220a8397b1dcdafull);  // SplitMix64's published first value
}

TEST(Random, FillsItsIntervalEvenly) {
  Random random(1);
  constexpr int kCount = 100000;
  double sum = 0, squares = 0, low = 5, high = 3;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.uniform(3, 5);
    sum += x, squares += x * x;
    low = std::min(low, x), high = std::max(high, x);
  }
  const double mean = sum / kCount;
  EXPECT_NEAR(mean, 4, 0.01);
  EXPECT_NEAR(squares / kCount - mean * mean, 4.0 / 12, 0.01);
  EXPECT_GE(low, 3);
  EXPECT_LT(high, 5);
}

}  // namespace
}  // namespace fascia
