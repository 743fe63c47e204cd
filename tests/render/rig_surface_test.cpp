#include <gtest/gtest.h>

#include <fascia/character/character.h>
#include <fascia/render/blended_skin.h>
#include <fascia/render/bone_mesh.h>
#include <fascia/render/character_scene.h>
#include <fascia/render/crease_normals.h>
#include <fascia/render/rig_surface.h>

#include "pictures.h"
#include "rigs.h"

namespace fascia {
namespace {

using Vec3f = Eigen::Vector3f;

TEST(CreaseNormals, AreTheFilesInTheBindPose) {
  RiggedModel model = test::cubeModel();
  // Bent by hand, as artists do to soften an edge.
  model.vertices[3].normal = (model.vertices[3].normal + Vec3f(0.1f, 0.2f, 0)).normalized();
  std::vector<Vec3f> normals;
  CreaseNormals(model).compute(test::drawnPositions(model), normals);
  ASSERT_EQ(normals.size(), model.vertices.size());
  for (std::size_t v = 0; v < normals.size(); ++v)
    EXPECT_LT((normals[v] - model.vertices[v].normal).norm(), 1e-5f) << v;
}

TEST(CreaseNormals, TurnWithTheSurfaceAndKeepItsEdges) {
  const RiggedModel model = test::cubeModel();
  const Eigen::Matrix3f turn =
      Eigen::AngleAxisf(1.1f, Vec3f(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vec3f> positions = test::drawnPositions(model), normals;
  for (Vec3f& p : positions) p = turn * p + Vec3f(3, 0, 1);
  CreaseNormals(model).compute(positions, normals);
  for (std::size_t v = 0; v < normals.size(); ++v)
    EXPECT_LT((normals[v] - turn * model.vertices[v].normal).norm(), 1e-5f) << v;
}

TEST(CreaseNormals, AreSharedWhereTheFilesAgree) {
  RiggedModel model = test::cubeModel();
  for (RigVertex& vertex : model.vertices)  // smooth: away from the middle
    vertex.normal = (model.points_m[vertex.point] - Vec3f(0, 0.5f, 0)).normalized();
  std::vector<Vec3f> positions = test::drawnPositions(model), normals;
  for (Vec3f& p : positions) p.x() += 0.6f * p.y() * p.y();
  CreaseNormals(model).compute(positions, normals);
  for (std::size_t a = 0; a < normals.size(); ++a)
    for (std::size_t b = 0; b < normals.size(); ++b)
      if (model.vertices[a].point == model.vertices[b].point) {
        EXPECT_LT((normals[a] - normals[b]).norm(), 1e-6f) << a << ' ' << b;
      }
  EXPECT_GT((normals[2] - model.vertices[2].normal).norm(), 0.05f);  // the shear is seen
}

TEST(CreaseNormals, IgnoreTheFilesWhereTheyPointInside) {
  RiggedModel model = test::cubeModel();
  for (RigVertex& vertex : model.vertices) vertex.normal *= -1;
  std::vector<Vec3f> normals;
  CreaseNormals(model).compute(test::drawnPositions(model), normals);
  for (std::size_t v = 0; v < normals.size(); ++v)
    EXPECT_GT(normals[v].dot(-model.vertices[v].normal), 0.99f);
}

TriangleMesh drawnCube(const RiggedModel& model) {
  TriangleMesh skin;
  skin.positions = test::drawnPositions(model);
  CreaseNormals(model).compute(skin.positions, skin.normals);
  return skin;
}

TEST(RigSurface, SplitsByMaterial) {
  const auto model = std::make_shared<const RiggedModel>(test::cubeModel());
  Scene scene;
  RigSurface(model).addTo(scene, drawnCube(*model), {});
  ASSERT_EQ(scene.drawables.size(), 2u);
  EXPECT_EQ(scene.drawables[0].mesh.triangles.size(), 10u);
  EXPECT_EQ(scene.drawables[1].mesh.triangles.size(), 2u);
  EXPECT_EQ(scene.drawables[1].mesh.positions.size(), 4u);
  for (const Vec3f& p : scene.drawables[1].mesh.positions) EXPECT_EQ(p.y(), 1);
  // glTF colours are linear, ours are sRGB (IEC 61966-2-1: 0.2 -> 0.4845).
  EXPECT_NEAR(scene.drawables[0].material.color.x(), 0.4845f, 1e-3f);
  EXPECT_TRUE(scene.drawables[1].material.color.isApprox(Rgb(1, 0, 0)));
}

TEST(RigSurface, IsOneVeilOverOtherLayers) {
  const auto model = std::make_shared<const RiggedModel>(test::cubeModel());
  Scene scene;
  RigSurface::Look look;
  look.veil = 0.25f;
  RigSurface(model).addTo(scene, drawnCube(*model), look);
  for (const Drawable& drawable : scene.drawables) {
    EXPECT_EQ(drawable.material.kind, Material::Kind::skin);
    EXPECT_EQ(drawable.material.opacity, 0.25f);
    EXPECT_EQ(drawable.material.color, scene.drawables[0].material.color);
  }
}

TEST(RigSurface, MetalMirrorsInItsOwnColour) {
  FASCIA_REQUIRE_GL();
  Scene scene = test::framed({test::sphere({0, 0, 0}, 1, {0.9f, 0.7f, 0.2f})});
  scene.drawables[0].material.roughness = 0.3f;
  const Pixels paint = test::draw(scene);
  scene.drawables[0].material.metallic = 1;
  const Pixels metal = test::draw(scene);
  EXPECT_GT(test::differing(paint, metal), 2000);
  const auto golden = [](int r, int g, int b) { return r > g + 10 && g > b + 30; };
  EXPECT_GT(test::count(metal, golden), 1500);
}

TEST(RigSurface, WrappedLightReachesBeyondTheEdgeOfDay) {
  FASCIA_REQUIRE_GL();
  Scene scene = test::framed({test::sphere({0, 0, 0}, 1, {0.5f, 0.5f, 0.5f})});
  scene.drawables[0].material.roughness = 1;
  const Vec3 dusk = Vec3(0.80, 0.92, 0.62).normalized().cross(Vec3(0, 0, 1)).normalized();
  const auto at = test::pixelOf(scene, -0.7 * dusk + Vec3(0, 0, 0.7), 160, 120);
  const int dark = test::sumAt(test::draw(scene), at[0], at[1]);
  scene.drawables[0].material.wrap = 1;
  EXPECT_NE(test::sumAt(test::draw(scene), at[0], at[1]), dark);
}

// Root on the floor, hips above it, a leg with a twist joint at its knee, and a handle.
RiggedModel leggedModel() {
  RiggedModel model = test::cubeModel();
  const auto add = [&](const char* name, int parent, double y) {
    model.joints.push_back({name, parent, {Mat3::Identity(), Vec3(0, y, 0)}, -1});
  };
  add("hips", 0, 1.0);
  add("knee", 1, 0.5);
  add("knee twist", 2, 0.5);
  add("foot", 3, 0.1);
  add("foot tip", 4, 0.0);
  add("handle", 0, 2.0);
  for (std::size_t p = 0; p < 8; ++p)
    model.weights[p].joint[0] = static_cast<std::uint16_t>(1 + p % 4);
  return model;
}

CharacterDef leggedCharacter(const std::shared_ptr<const RiggedModel>& model) {
  CharacterDef def;
  def.name = "legs";
  for (const RigJoint& joint : model->joints) {
    JointDef made;
    made.name = joint.name;
    if (joint.parent >= 0) {
      const RigJoint& parent = model->joints[static_cast<std::size_t>(joint.parent)];
      made.parent = parent.name;
      made.offset_m = joint.rest_world.translation_m - parent.rest_world.translation_m;
    }
    def.skeleton.joints.push_back(made);
  }
  def.rig = RigDef{"legs.glb", 1, model};
  return def;
}

TEST(BoneSizes, ShowOnlyWhatMovesTheSurface) {
  const auto model = std::make_shared<const RiggedModel>(leggedModel());
  const Character character(leggedCharacter(model));
  const BoneSizes sizes = boneSizes(character.skeleton(), *model);
  const std::vector<char> shafts = {0, 0, 1, 0, 1, 1, 0};  // root … handle
  EXPECT_EQ(sizes.hasShaft, shafts);
  EXPECT_EQ(sizes.ball_m[0], 0);
  EXPECT_EQ(sizes.ball_m[6], 0);
  EXPECT_GT(sizes.ball_m[1], sizes.ball_m[5]);  // as thick as it is long
  const CharacterState state = initialState(character, character.source(-1));
  const TriangleMesh mesh = boneMesh(character.skeleton(), state.skeleton, sizes);
  Box box;
  for (const Vec3f& p : mesh.positions) box.add(p.cast<double>());
  EXPECT_LT(box.high.y(), 1.1);
}

TEST(BlendedSkin, FollowsTheJointsOfTheCharacter) {
  const auto model = std::make_shared<const RiggedModel>(leggedModel());
  const Character character(leggedCharacter(model));
  CharacterState state = initialState(character, character.source(-1));
  BlendedSkin blended(character);
  std::vector<Vec3f> positions;
  blended.compute(state, positions);
  const std::vector<Vec3f> rest = test::drawnPositions(*model);
  ASSERT_EQ(positions.size(), rest.size());
  for (std::size_t v = 0; v < rest.size(); ++v) EXPECT_LT((positions[v] - rest[v]).norm(), 1e-6f);
  for (Transform& joint : state.skeleton.joint_world) joint.translation_m += Vec3(0, 0, 2);
  blended.compute(state, positions);
  for (std::size_t v = 0; v < rest.size(); ++v)
    EXPECT_LT((positions[v] - rest[v] - Vec3f(0, 0, 2)).norm(), 1e-6f);
}

TEST(CharacterOnARig, ShowsItsSurfaceAndItsBones) {
  const auto model = std::make_shared<const RiggedModel>(leggedModel());
  const Character character(leggedCharacter(model));
  const CharacterState state = initialState(character, character.source(-1));
  SceneOptions options;
  options.ground = false;
  const TriangleMesh skin = drawnCube(*model);
  EXPECT_EQ(buildScene(character, state, skin, options).drawables.size(), 2u);
  options.layers = parseLayers("skeleton,skin");
  const Scene scene = buildScene(character, state, skin, options);
  ASSERT_EQ(scene.drawables.size(), 3u);
  EXPECT_EQ(scene.drawables[0].material.kind, Material::Kind::bone);
  EXPECT_LT(scene.drawables[1].material.opacity, 1);
}

}  // namespace
}  // namespace fascia
