#include <gtest/gtest.h>

#include <fascia/base/parallel.h>

#include "small_character.h"
#include "support/count_allocations.h"

namespace fascia {
namespace {

TEST(Allocation, AdvancingMakesNoneAfterWarmUp) {
  const ThreadLimit limit(1);
  for (const int side : {16, 80}) {  // the second rides on a coarse grid
    CharacterDef def = test::fineCharacter(side);
    def.skin->material.bending_Nm = side == 16 ? 1e-3 : 0;
    SoftSolidDef& soft = def.flesh.solids[1].soft.emplace();
    if (side == 16) soft.basis.kind = BodyBasisDef::Kind::polynomial;
    const Character character(def);
    ASSERT_EQ(character.skin()->coarse() != nullptr, side == 80);
    CharacterState state = initialState(character, character.source(0));
    SkinStats stats;
    const long before = allocations;
    const CharacterState copy = state;
    EXPECT_GT(allocations, before);  // the counter counts
    for (int f = 0; f < 3; ++f) advance(character, character.source(0), 1.0 / 60, state, stats);
    const long warm = allocations;
    for (int f = 0; f < 20; ++f) advance(character, character.source(0), 1.0 / 60, state, stats);
    EXPECT_EQ(allocations - warm, 0) << side;
  }
}

}  // namespace
}  // namespace fascia
