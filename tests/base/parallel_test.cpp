#include <fascia/base/parallel.h>

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <vector>

#include <fascia/base/aligned.h>
#include <fascia/base/hash.h>
#include <fascia/base/ids.h>

namespace fascia {
namespace {

std::uint64_t hashWithThreads(int threads) {
  const ThreadLimit limit(threads);
  std::vector<double> values(10007);
  parallelFor(values.size(), [&](std::size_t i) {
    double x = static_cast<double>(i) + 0.5;
    for (int k = 0; k < 20; ++k) x = std::sin(x) * 3 + std::sqrt(x * x + 1);
    values[i] = x;
  });
  StateHash hash;
  hash.add(values.data(), values.size() * sizeof(double));
  return hash.value();
}

TEST(ParallelFor, GivesTheSameBitsOnAnyNumberOfThreads) {
  const std::uint64_t one = hashWithThreads(1);
  EXPECT_EQ(one, hashWithThreads(2));
  EXPECT_EQ(one, hashWithThreads(4));
}

TEST(ParallelFor, RunsEveryTaskExactlyOnce) {
  for (const std::size_t count : {0u, 1u, 2u, 1000u}) {
    std::vector<std::atomic<int>> runs(count);
    parallelFor(count, [&](std::size_t i) { ++runs[i]; });
    for (const auto& r : runs) EXPECT_EQ(r, 1);
  }
}

TEST(ThreadLimit, HoldsWhileItLives) {
  const int before = threadLimit();
  {
    const ThreadLimit limit(1);
    EXPECT_EQ(threadLimit(), 1);
  }
  EXPECT_EQ(threadLimit(), before);
  {
    const ThreadLimit all(0);
    EXPECT_EQ(threadLimit(), hardwareThreads());
  }
  EXPECT_GE(hardwareThreads(), 1);
}

TEST(VectorArray, StartsEveryComponentOnACacheLine) {
  const VectorArray a(17);
  for (const FloatArray* component : {&a.x, &a.y, &a.z})
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(component->data()) % kSimdAlignment, 0);
}

TEST(VectorArray, ViewsWriteThrough) {
  VectorArray a(10);
  a.fill(1);
  const Vectors part = view(a, 3, 4);
  part.y[1] = 7;
  EXPECT_EQ(part.count, 4);
  EXPECT_EQ(a.y[4], 7);
  EXPECT_EQ(a.y[3], 1);
}

TEST(Id, KnowsWhetherItPointsAnywhere) {
  EXPECT_FALSE(JointId().valid());
  EXPECT_TRUE(JointId(0).valid());
  EXPECT_EQ(JointId(5).index(), 5);
  EXPECT_LT(JointId(2), JointId(3));
  static_assert(!std::is_convertible_v<JointId, SolidId>);
  static_assert(!std::is_constructible_v<SolidId, JointId>);
}

}  // namespace
}  // namespace fascia
