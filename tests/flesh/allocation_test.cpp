#include <gtest/gtest.h>

#include "arm.h"
#include "support/count_allocations.h"

namespace fascia {
namespace {

TEST(Allocation, PosingMakesNoneAfterWarmUp) {
  const test::Arm arm;
  const BoundClip clip = test::flexClip(arm);

  Posture posture;
  PosedSkeleton skeleton;
  PosedFlesh flesh;
  std::vector<Flesh::ParameterOverride> overrides;
  VectorArray points(64), out(64);
  std::vector<float> distance_m(64);
  const auto frame = [&](double time_s) {
    samplePosture(clip, arm.skeleton, time_s, posture);
    sampleParameters(clip, time_s, overrides);
    arm.skeleton.pose(posture, skeleton);
    arm.flesh.pose(posture, skeleton, overrides, flesh);
    for (std::size_t i = 0; i < flesh.solidCount(); ++i) {
      const SolidId id{static_cast<int>(i)};
      flesh.evaluate(id, view(points, 0, 64), distance_m.data(), view(out, 0, 64));
      flesh.velocity(id, view(points, 0, 64), view(out, 0, 64));
      flesh.worldFromMaterials(id, view(points, 0, 64), view(out, 0, 64));
    }
  };
  const long before = allocations;
  frame(0);
  EXPECT_GT(allocations, before);  // the counter counts
  const long warm = allocations;
  for (int i = 1; i < 100; ++i) frame(0.037 * i);
  EXPECT_EQ(allocations, warm);
}

}  // namespace
}  // namespace fascia
