#include <gtest/gtest.h>

#include <fascia/base/random.h>
#include <fascia/contact/broad_phase.h>

namespace fascia {
namespace {

// Boxes all over a room, every seventh of them empty.
std::vector<Box> scattered(std::size_t count, Random& random) {
  std::vector<Box> boxes(count);
  const auto within = [&](double r) {
    return Vec3(random.uniform(-r, r), random.uniform(-r, r), random.uniform(-r, r));
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 7 == 3) continue;
    boxes[i].add(within(1));
    boxes[i].add(Vec3(boxes[i].low + within(0.9)));
  }
  return boxes;
}

TEST(BroadPhase, FindsWhatMeetsAndNothingElse) {
  Random random(5);
  BroadPhase phase;
  std::vector<std::uint32_t> found;
  std::size_t met = 0;
  for (const std::size_t count : {200u, 0u, 1u, 37u, 500u}) {  // up and down: updates forget
    const std::vector<Box> boxes = scattered(count, random);
    phase.update(boxes);
    for (const Box& box : scattered(100, random)) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t i = 0; i < boxes.size(); ++i)
        if (meets(box, boxes[i])) expected.push_back(i);
      phase.find(box, found);
      ASSERT_EQ(found, expected) << count;
      met += found.size();
    }
  }
  EXPECT_GT(met, 500u);
}

}  // namespace
}  // namespace fascia
