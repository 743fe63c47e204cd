#include <gtest/gtest.h>

#include <fascia/character/editing.h>
#include <fascia/skin/surface/surface_rest.h>

#include "small_character.h"

namespace fascia {
namespace {

CharacterDef surfaceCharacter() {
  CharacterDef def = test::smallCharacter();
  def.skin->grid.bottom = def.skin->grid.top = {};
  def.skin->grid.columns = def.skin->grid.rows = SkinGridDef{}.columns;
  def.skin->surface = SkinSurfaceDef{.edge_m = 0.06};
  return def;
}

void play(const Character& character, int frames, CharacterState& state) {
  SkinStats stats;
  for (int f = 0; f < frames; ++f) advance(character, character.source(0), 1.0 / 60, state, stats);
  EXPECT_EQ(stats.repaired_points, 0u);
}

TEST(SurfaceCharacter, WarnsOfNothingAndMoves) {
  const Character character(surfaceCharacter());
  EXPECT_TRUE(character.warnings().empty());
  EXPECT_EQ(character.skin()->grid(), nullptr);
  CharacterState state = initialState(character, character.source(0));
  const VectorArray before = state.skin.position;
  play(character, 30, state);
  EXPECT_TRUE(test::allFinite(character, state));
  EXPECT_FALSE(test::sameBits(before, state.skin.position));
}

TEST(SurfaceCharacter, WarnsOfATubeThatLeavesLimbsOutside) {
  CharacterDef def = test::smallCharacter();
  FleshSolidDef arm = test::ball("arm", "spine", 0.05, 0.08);
  arm.position_m.x() = 0.9;
  def.flesh.solids.push_back(arm);
  def.skin->grid.top.position_m = Vec3(0, 0.15, 0);
  const Character character(def);
  ASSERT_EQ(character.warnings().size(), 1u);
  EXPECT_EQ(character.warnings()[0].where.pointer, "/skin");
  EXPECT_NE(character.warnings()[0].message.find("'arm'"), std::string::npos);
  // An edit that keeps the wrap keeps the warning.
  def.skin->material.drag_Ns_per_m3 = 9;
  EXPECT_EQ(character.edited(def).warnings().size(), 1u);
  def.skin->grid.bottom = def.skin->grid.top = {};
  def.skin->grid.columns = def.skin->grid.rows = SkinGridDef{}.columns;
  def.skin->surface.emplace();
  EXPECT_TRUE(character.edited(def).warnings().empty());
}

TEST(SurfaceCharacter, EditedHasTheBitsOfAFreshOne) {
  const Character start(surfaceCharacter());
  CharacterDef def = start.def();
  def.skin->material.drag_Ns_per_m3 = 7;
  const Character material = start.edited(def);
  EXPECT_EQ(material.skin()->parts().shape, start.skin()->parts().shape);
  def.flesh.solids[1].position_m.x() = 0.03;
  def.skin->fat.thickness_m = 0.02;
  const Character edited = material.edited(def), fresh(def);
  EXPECT_NE(edited.skin()->parts().shape, start.skin()->parts().shape);
  CharacterState a = initialState(edited, edited.source(0)),
                 b = initialState(fresh, fresh.source(0));
  play(edited, 10, a);
  play(fresh, 10, b);
  EXPECT_EQ(hashOf(edited, a), hashOf(fresh, b));
}

TEST(SurfaceCharacter, GoesOnThroughAnEditOfItsMaterialAndStartsAnewWithItsSurface) {
  const Character start(surfaceCharacter());
  CharacterState state = initialState(start, start.source(0));
  play(start, 20, state);
  CharacterDef def = start.def();
  def.skin->material.density_kg_per_m2 = 6;
  const Character heavier = start.edited(def);
  CharacterState carried = carryOver(start, state, heavier);
  EXPECT_TRUE(test::sameBits(carried.skin.position, state.skin.position));
  play(heavier, 20, carried);
  def.flesh.solids[0].solid.parameters = {0.28};
  const Character fatter = heavier.edited(def);
  CharacterState anew = carryOver(heavier, carried, fatter);
  EXPECT_NO_THROW(requireFits(fatter, anew));
  play(fatter, 20, anew);
  EXPECT_TRUE(test::allFinite(fatter, anew));
}

TEST(SurfaceCharacter, FallsBackToAGridAndForthAgain) {
  const Character start(surfaceCharacter());
  const Character grid = start.edited(test::smallCharacter());
  ASSERT_NE(grid.skin()->grid(), nullptr);
  const Character back = grid.edited(surfaceCharacter());
  ASSERT_NE(back.skin()->surface(), nullptr);
  EXPECT_TRUE(test::sameBits(back.skin()->restPosition(), start.skin()->restPosition()));
}

}  // namespace
}  // namespace fascia
