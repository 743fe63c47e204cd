// Counts every allocation of this program: what runs each frame must make none after warm-up.
// The operators stay out of line: inlined, g++ 12 takes their malloc and free for a mismatch.
#include <atomic>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include <fascia/base/parallel.h>

#include "small_character.h"

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

TEST(Allocation, AdvancingMakesNoneAfterWarmUp) {
  const ThreadLimit limit(1);
  for (const int side : {16, 80}) {  // the second rides on a coarse grid
    CharacterDef def = test::fineCharacter(side);
    def.skin->material.bending_Nm = side == 16 ? 1e-3 : 0;
    const Character character(def);
    ASSERT_EQ(character.skin()->coarse() != nullptr, side == 80);
    CharacterState state = initialState(character, 0);
    SkinStats stats;
    const long before = allocations;
    const CharacterState copy = state;
    EXPECT_GT(allocations, before);  // the counter counts
    for (int f = 0; f < 3; ++f) advance(character, 0, 1.0 / 60, state, stats);
    const long warm = allocations;
    for (int f = 0; f < 20; ++f) advance(character, 0, 1.0 / 60, state, stats);
    EXPECT_EQ(allocations - warm, 0) << side;
  }
}

}  // namespace
}  // namespace fascia
