#include <gtest/gtest.h>

#include <fascia/render/stage_scene.h>

#include "character/small_character.h"
#include "world/scenes.h"

namespace fascia {
namespace {

SceneDef stageDef() {
  SceneDef def;
  def.bodies = {test::ball("a", Vec3(1, 2, 3)), test::ball("b", Vec3(-1, 1, 0))};
  PlacedSolidDef& eye = def.bodies[0].ornaments.emplace_back();
  eye.solid.shape = "sphere";
  eye.solid.parameters = {0.05};
  eye.position_m = Vec3(0, 0, 0.2);
  PlacedSolidDef& stone = def.props.emplace_back();
  stone.name = "stone";
  stone.solid.shape = "sphere";
  stone.solid.parameters = {0.3};
  stone.position_m = Vec3(4, 0.5, 6);
  return def;
}

void expectBox(const Box& box, const Vec3& center_m, double radius_m) {
  EXPECT_LT((0.5 * (box.low + box.high) - center_m).norm(), 0.01 * radius_m);
  EXPECT_NEAR(box.size().maxCoeff(), 2 * radius_m, 0.02 * radius_m);
}

SceneOptions withoutGround() {
  SceneOptions options;
  options.ground = false;
  return options;
}

TEST(StageScene, BodiesOrnamentsAndPropsAreWhereTheyShouldBe) {
  const Stage stage(stageDef());
  const StagePictures pictures(stage);
  OdeState state = stage.startState(0);
  stage.bodies().place(BodyId(1), {Mat3::Identity(), Vec3(5, 6, 7)}, state);
  const Scene scene = pictures.scene({state.r, {}}, withoutGround());
  ASSERT_EQ(scene.drawables.size(), 4u);
  expectBox(worldBounds(scene.drawables[0]), Vec3(1, 2, 3), 0.2);
  expectBox(worldBounds(scene.drawables[1]), Vec3(1, 2, 3.2), 0.05);
  expectBox(worldBounds(scene.drawables[2]), Vec3(5, 6, 7), 0.2);
  expectBox(worldBounds(scene.drawables[3]), Vec3(4, 0.5, 6), 0.3);
}

TEST(StageScene, CharactersAreAtTheirPlaces) {
  SceneDef def = stageDef();
  CharacterDef doll = test::smallCharacter();
  doll.skin.reset();
  SceneCharacterDef& actor = def.characters.emplace_back();
  actor.name = "doll";
  actor.position_m = Vec3(-3, 0.5, 2);
  actor.heading_rad = 1;
  actor.character = std::make_shared<const Character>(doll);
  const Stage stage(def);
  const CharacterState state = initialState(*actor.character, actor.character->source(-1));
  const TriangleMesh skin;
  SceneOptions options = withoutGround();
  options.layers = parseLayers("muscle");
  const OdeState start = stage.startState(0);
  const Scene scene =
      StagePictures(stage).scene({start.r, {{&state, &skin, nullptr, nullptr}}}, options);
  ASSERT_EQ(scene.drawables.size(), 1u + doll.flesh.solids.size());    // after the prop
  expectBox(worldBounds(scene.drawables[1]), Vec3(-3, 1.5, 2), 0.25);  // the belly, at the hip
}

TEST(StageScene, ReachHoldsBodiesAndPropsOfEveryMoment) {
  const Stage stage(stageDef());
  const StagePictures pictures(stage);
  OdeState state = stage.startState(0);
  Reach reach;
  pictures.addTo(state.r, reach);
  EXPECT_NEAR(reach.box().high.z(), 6.3, 0.01);
  EXPECT_NEAR(reach.box().low.x(), -1.2, 0.01);
  stage.bodies().place(BodyId(1), {Mat3::Identity(), Vec3(-8, 1, 0)}, state);
  pictures.addTo(state.r, reach);
  EXPECT_NEAR(reach.box().low.x(), -8.2, 0.01);
  EXPECT_NEAR(reach.box().high.z(), 6.3, 0.01);
}

}  // namespace
}  // namespace fascia
