#include <fascia/io/gltf/gltf_keys.h>

#include <gtest/gtest.h>

#include <cmath>

#include <fascia/math/types.h>

namespace fascia {
namespace {

using Mode = GltfKeys::Mode;

GltfKeys keysOf(Mode mode, std::vector<float> times, std::vector<float> values) {
  GltfKeys keys;
  keys.mode = mode;
  keys.times_s = std::move(times);
  keys.values = std::move(values);
  return keys;
}

// The same curve at all times, whatever the keys.
void expectSame(const GltfKeys& whole, const GltfKeys& cut, double from_s, double to_s) {
  for (int i = 0; i <= 50; ++i) {
    const double t = from_s + (to_s - from_s) * i / 50;
    EXPECT_NEAR(whole.valueAt(t)[0], cut.valueAt(t)[0], 2e-6) << t;
  }
  EXPECT_NEAR(cut.times_s.front(), from_s, 1e-6);
  EXPECT_NEAR(cut.times_s.back(), to_s, 1e-6);
}

TEST(GltfKeys, ACutShowsThePartOfACurveExactly) {
  const GltfKeys linear = keysOf(Mode::linear, {0, 0.6f, 1.2f}, {0, 1, 0});
  EXPECT_NEAR(linear.valueAt(0.3)[0], 0.5, 1e-6);
  expectSame(linear, cutGltfKeys(linear, {0.1, 0.7}), 0.1, 0.8);
  // Per key: in-tangent, value, out-tangent.
  const GltfKeys cubic = keysOf(Mode::cubic, {0.2f, 1, 2.5f}, {0, 1, 3, -2, 2, 4, 1, -1, 0});
  expectSame(cubic, cutGltfKeys(cubic, {0.4, 1.7}), 0.4, 2.1);
  expectSame(cubic, cutGltfKeys(cubic, {0, 1.3}), 0, 1.3);  // rests until its first key
  const GltfKeys step = keysOf(Mode::step, {0, 1}, {3, 5});
  const GltfKeys part = cutGltfKeys(step, {0.5, 1});
  EXPECT_EQ(part.valueAt(0.9)[0], 3);
  EXPECT_EQ(part.valueAt(1.2)[0], 5);
}

TEST(GltfKeys, RestsInTheLastValueBeyondTheEnd) {
  const GltfKeys linear = keysOf(Mode::linear, {0, 1}, {0, 2});
  const GltfKeys longer = cutGltfKeys(linear, {0, 3});
  EXPECT_NEAR(longer.times_s.back(), 3, 1e-6);
  EXPECT_NEAR(longer.valueAt(0.5)[0], 1, 1e-6);
  EXPECT_NEAR(longer.valueAt(2.5)[0], 2, 1e-6);
}

TEST(GltfKeys, RepeatsWhatLoops) {
  for (const float last : {0.0f, 1.0f}) {  // meets its beginning, or jumps back to it
    const GltfKeys keys = keysOf(Mode::linear, {0, 0.5f, 1}, {0, 2, last});
    const GltfKeys thrice = cutGltfKeys(keys, {.start_s = 0, .length_s = 2.75, .period_s = 1});
    for (const double t : {0.25, 1.25, 2.25, 1.5, 2.6})
      EXPECT_NEAR(thrice.valueAt(t)[0], keys.valueAt(t - std::floor(t))[0], 1e-5) << t;
    for (std::size_t k = 1; k < thrice.times_s.size(); ++k)
      EXPECT_GT(thrice.times_s[k], thrice.times_s[k - 1]);
  }
}

TEST(GltfKeys, TurnsStayOnTheWayBetweenTheirKeys) {
  const auto s = static_cast<float>(std::sqrt(0.5));
  GltfKeys keys = keysOf(Mode::linear, {0, 1}, {0, 0, 0, 1, s, 0, 0, s});
  keys.width = 4, keys.turns = true;
  const GltfKeys half = cutGltfKeys(keys, {0, 0.5});
  const std::vector<float> end = half.valueAt(0.5);
  EXPECT_NEAR(end[0], std::sin(kPi / 8), 1e-6);
  EXPECT_NEAR(half.valueAt(0.25)[0], std::sin(kPi / 16), 1e-6);
}

TEST(GltfKeys, RefusesToWriteWithoutEnd) {
  const GltfKeys keys = keysOf(Mode::linear, {0, 1}, {0, 2});
  EXPECT_TRUE(cutGltfKeys(keys, {0, 1e9, 0.01}).times_s.empty());
}

}  // namespace
}  // namespace fascia
