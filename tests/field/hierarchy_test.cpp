#include <gtest/gtest.h>

#include <algorithm>

#include <fascia/base/random.h>
#include <fascia/field/hierarchy.h>

namespace fascia {
namespace {

Box randomBox(Random& random) {
  const Vec3 low(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  return {low, low + Vec3(random.uniform(0, 0.5), random.uniform(0, 0.5), random.uniform(0, 0.5))};
}

TEST(SolidHierarchy, FindsWhatBruteForceFindsInAscendingOrder) {
  Random random(41);
  for (const std::size_t count : {0u, 1u, 2u, 7u, 40u}) {
    std::vector<Box> boxes(count);
    for (Box& box : boxes) box = randomBox(random);
    SolidHierarchy hierarchy;
    hierarchy.build(boxes);
    std::vector<SolidId> found(count);
    std::size_t total = 0;
    for (int i = 0; i < 100; ++i) {
      if (i == 50) {  // another pose
        for (Box& box : boxes) box = randomBox(random);
        hierarchy.refit(boxes);
      }
      const Box query = randomBox(random);
      const double margin_m = random.uniform(0, 0.2);
      std::vector<SolidId> expected;
      for (std::size_t k = 0; k < count; ++k) {
        Box grown = boxes[k];
        grown.low.array() -= margin_m, grown.high.array() += margin_m;
        if (meets(grown, query)) expected.emplace_back(static_cast<std::int64_t>(k));
      }
      const std::size_t n = hierarchy.query(query, margin_m, found);
      EXPECT_EQ(std::vector<SolidId>(found.begin(), found.begin() + static_cast<long>(n)),
                expected);
      total += n;
    }
    EXPECT_EQ(total > 0, count > 0);
  }
}

}  // namespace
}  // namespace fascia
