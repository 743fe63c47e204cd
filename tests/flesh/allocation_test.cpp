// Counts every allocation of this program: what runs each frame must make none after warm-up.
// The operators stay out of line: inlined, g++ 12 takes their malloc and free for a mismatch.
#include <atomic>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "arm.h"

namespace {
std::atomic<long> allocations{0};
}

[[gnu::noinline]] void* operator new(std::size_t bytes) {
  ++allocations;
  if (void* p = std::malloc(bytes ? bytes : 1)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t bytes, std::align_val_t alignment) {
  ++allocations;
  const auto a = static_cast<std::size_t>(alignment);
  if (void* p = std::aligned_alloc(a, (bytes + a - 1) / a * a)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept {
  std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::align_val_t) noexcept {
  std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}

namespace fascia {
namespace {

TEST(Allocation, PosingMakesNoneAfterWarmUp) {
  const test::Arm arm;
  MotionDef motion;
  motion.name = "flex";
  motion.duration_s = 2;
  motion.loop = true;
  motion.tracks = {{TrackDef::Target::joint, "elbow", "rz", {{0, 0}, {1, 2}}},
                   {TrackDef::Target::solid, "thumb", "bend.angle_rad", {{0, 0.2}, {1, 0.9}}}};
  Diagnostics diagnostics;
  const BoundClip clip = bindMotion(motion, arm.skeleton, arm.flesh, {}, "/m", diagnostics);
  ASSERT_TRUE(diagnostics.ok());

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
