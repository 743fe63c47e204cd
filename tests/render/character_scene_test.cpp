#include <gtest/gtest.h>

#include <fascia/render/bone_mesh.h>
#include <fascia/render/character_scene.h>

#include "pictures.h"

namespace fascia {
namespace {

// A trunk with an arm to its left (+x) and an eye in front; no elastic skin: a mesh stands in.
CharacterDef trunkWithArm() {
  CharacterDef def;
  def.name = "trunk";
  JointDef root, spine, arm;
  root.name = "root";
  spine.name = "spine", spine.parent = "root", spine.offset_m = Vec3(0, 1, 0);
  arm.name = "arm", arm.parent = "spine", arm.offset_m = Vec3(0.7, -0.2, 0);
  arm.dofs = {{Dof::rz, -2, 2, 0}};
  def.skeleton.joints = {root, spine, arm};
  FleshSolidDef belly, eye;
  belly.name = "belly", belly.joint = "root", belly.position_m = Vec3(0, 0.5, 0);
  belly.solid.shape = "sphere";
  belly.solid.parameters = {0.4};
  eye = belly;
  eye.name = "left eye", eye.position_m = Vec3(0, 0.9, 0.45);
  eye.solid.parameters = {0.06};
  eye.color = {0.02f, 0.02f, 0.02f};
  def.flesh.solids = {belly};
  def.ornaments.solids = {eye};
  return def;
}

class CharacterSceneTest : public testing::Test {
 protected:
  Pixels drawn(const char* layers, const char* camera = "front") {
    SceneOptions options;
    options.layers = parseLayers(layers);
    options.camera = parseCamera(camera);
    options.framing = visibleBounds(state_, skin_, parseLayers("all"));
    options.aspect = 4.0 / 3;
    return test::draw(buildScene(character_, state_, skin_, options));
  }

  Character character_{trunkWithArm()};
  CharacterState state_ = initialState(character_, character_.source(-1));
  TriangleMesh skin_ = test::sphereMesh({0, 0.55f, 0}, 0.55f);
};

TEST(Layers, AreReadByName) {
  EXPECT_TRUE(parseLayers("skin").skin);
  EXPECT_FALSE(parseLayers("skin").muscle);
  const Layers two = parseLayers("skeleton,muscle");
  EXPECT_TRUE(two.skeleton && two.muscle && !two.skin);
  const Layers all = parseLayers("all");
  EXPECT_TRUE(all.skeleton && all.muscle && all.skin);
  for (const char* text : {"", "skn", "skin,", ",skin", "Skin", "skin;muscle"})
    EXPECT_THROW(parseLayers(text), Error) << text;
}

TEST_F(CharacterSceneTest, EveryLayerLeavesItsMark) {
  FASCIA_REQUIRE_GL();
  const Pixels all = drawn("all");
  EXPECT_GT(test::differing(all, drawn("muscle,skin")), 150);    // without bones
  EXPECT_GT(test::differing(all, drawn("skeleton,skin")), 600);  // without muscles
  EXPECT_GT(test::differing(all, drawn("skeleton,muscle")), 600);
  const auto fleshRed = [](int r, int g, int b) { return r > g + 50 && r > b + 50; };
  EXPECT_GT(test::count(drawn("muscle"), fleshRed), 1000);
  EXPECT_LT(test::count(drawn("skeleton"), fleshRed), 10);
}

TEST_F(CharacterSceneTest, TheArmIsOnTheRightOfAFrontView) {
  FASCIA_REQUIRE_GL();
  const Pixels with = drawn("skeleton"), from = drawn("skeleton", "back");
  const auto ivoryAt = [](const Pixels& p, int x0, int x1) {
    int n = 0;
    for (int y = 0; y < p.height; ++y)
      for (int x = x0; x < x1; ++x) {
        const auto c = test::rgbAt(p, x, y);
        n += c[0] > c[2] + 15 ? 1 : 0;
      }
    return n;
  };
  EXPECT_GT(ivoryAt(with, 100, 160), ivoryAt(with, 0, 50) + 20);
  EXPECT_GT(ivoryAt(from, 0, 60), ivoryAt(from, 110, 160) + 20);
}

TEST_F(CharacterSceneTest, EyesAreGlossyAndSeenWithTheSkinOnly) {
  SceneOptions options;
  const Scene skin = buildScene(character_, state_, skin_, options);
  ASSERT_EQ(skin.drawables.size(), 3u);  // eye, skin, ground
  EXPECT_LT(skin.drawables[0].material.roughness, 0.1f);
  options.layers = parseLayers("skeleton");
  options.ground = false;
  EXPECT_EQ(buildScene(character_, state_, skin_, options).drawables.size(), 1u);
}

TEST_F(CharacterSceneTest, SkinIsOpaqueAloneAndAVeilOverOtherLayers) {
  SceneOptions options;
  const auto opacity = [&] {
    for (const Drawable& d : buildScene(character_, state_, skin_, options).drawables)
      if (d.material.kind == Material::Kind::skin) return d.material.opacity;
    return -1.f;
  };
  EXPECT_EQ(opacity(), 1);
  options.layers = parseLayers("all");
  EXPECT_GT(opacity(), 0);
  EXPECT_LT(opacity(), 0.5f);
}

TEST_F(CharacterSceneTest, VisibleBoundsHoldWhatTheLayersShow) {
  const Box skin = visibleBounds(state_, skin_, parseLayers("skin"));
  EXPECT_NEAR(skin.high.y(), 1.1, 1e-3);
  EXPECT_NEAR(visibleBounds(state_, skin_, parseLayers("skeleton")).high.x(), 0.7, 1e-9);
  EXPECT_LE(visibleBounds(state_, skin_, parseLayers("muscle")).low.x(), -0.4);
}

TEST_F(CharacterSceneTest, BonesKeepTheirTrianglesInEveryPosture) {
  const TriangleMesh rest = boneMesh(character_.skeleton(), state_.skeleton);
  PosedSkeleton folded = state_.skeleton;
  folded.joint_world[2].translation_m = folded.joint_world[1].translation_m;  // no length
  const TriangleMesh other = boneMesh(character_.skeleton(), folded);
  EXPECT_EQ(rest.triangles, other.triangles);
  EXPECT_EQ(rest.positions.size(), other.positions.size());
  EXPECT_GT(enclosedVolume(rest), 0);  // faces outwards
  for (const auto& n : other.normals) EXPECT_NEAR(n.norm(), 1, 1e-4f);
}

}  // namespace
}  // namespace fascia
