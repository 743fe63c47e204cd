// From a rigged file to living skin: import, fitting, simulation.
#include <gtest/gtest.h>

#include <fascia/character/character.h>

#include "fleshed_rig.h"
#include "support/assets.h"

namespace fascia {
namespace {

using test::fleshOut;

TEST(RigCharacter, SkinRidesOnSoftFlesh) {
  const auto file = assetFile("mesh2motion-cc0/fox-animations.glb");
  if (!file) GTEST_SKIP() << "the shared assets are not here";
  CharacterDef def = fleshOut(file->string());
  const Character rigid(def);
  SolidId largest;
  for (std::size_t i = 0; i < def.flesh.solids.size(); ++i) {
    const SolidId id(static_cast<std::int64_t>(i));
    const auto volume_m3 = [&](SolidId s) { return rigid.flesh().restSolid(s).volume_m3(); };
    if (!largest.valid() || volume_m3(id) > volume_m3(largest)) largest = id;
  }
  FleshSolidDef& solid = def.flesh.solids[largest.index()];
  solid.drivers.clear();
  SoftSolidDef& soft = solid.soft.emplace();
  soft.basis.kind = BodyBasisDef::Kind::polynomial;
  soft.rigidity_Pa = 4e3, soft.volume_Pa = 1e4;
  const Character character(def);
  const int walk = character.findMotion("Walk");
  CharacterState state = initialState(character, character.source(walk)),
                 before = initialState(rigid, rigid.source(walk));
  SkinStats stats, ignored;
  for (int frame = 0; frame < 10; ++frame) {
    advance(character, character.source(walk), 1.0 / 30, state, stats);
    advance(rigid, rigid.source(walk), 1.0 / 30, before, ignored);
    measureSkin(*character.skin(), {&state.flesh, state.skeleton.joint_world}, state.skin, stats);
  }
  const double height_m = def.rig->model->height_m();
  float farthest_m = 0;
  for (std::size_t k = 0; k < state.skin.position.size(); ++k)
    farthest_m =
        std::max(farthest_m, std::hypot(state.skin.position.x[k] - before.skin.position.x[k],
                                        state.skin.position.y[k] - before.skin.position.y[k],
                                        state.skin.position.z[k] - before.skin.position.z[k]));
  EXPECT_GT(farthest_m, 1e-3 * height_m);
  EXPECT_EQ(stats.repaired_points, 0u);
}

TEST(RigCharacter, WalksInItsSkin) {
  const auto file = assetFile("mesh2motion-cc0/fox-animations.glb");
  if (!file) GTEST_SKIP() << "the shared assets are not here";
  const Character character(fleshOut(file->string()));
  const RiggedModel& rig = *character.def().rig->model;
  const int walk = character.findMotion("Walk");
  ASSERT_GE(walk, 0);
  CharacterState state = initialState(character, character.source(walk));
  SkinStats stats;
  TriangleMesh before, mesh;
  skinSurface(*character.skin(), state.flesh, state.skin, before);
  for (int frame = 0; frame < 30; ++frame) {
    advance(character, character.source(walk), 1.0 / 30, state, stats);
    measureSkin(*character.skin(), {&state.flesh, state.skeleton.joint_world}, state.skin, stats);
  }
  skinSurface(*character.skin(), state.flesh, state.skin, mesh);
  ASSERT_EQ(mesh.positions.size(), rig.vertices.size());
  double farthest = 0;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    ASSERT_TRUE(mesh.positions[i].allFinite()) << i;
    farthest = std::max(farthest, double{(mesh.positions[i] - before.positions[i]).norm()});
  }
  EXPECT_GT(farthest, 0.01 * rig.height_m());  // it does walk
  EXPECT_LT(stats.max_edge_stretch, 3);
  EXPECT_EQ(stats.repaired_points, 0u);
}

TEST(RigCharacter, MovesItsJointsAsTheFileDoes) {
  const auto file = assetFile("mesh2motion-cc0/fox-animations.glb");
  if (!file) GTEST_SKIP() << "the shared assets are not here";
  CharacterDef def = fleshOut(file->string());
  def.skin.reset();
  const Character character(def);
  const RiggedModel& rig = *character.def().rig->model;
  ASSERT_EQ(character.motionCount(), rig.motions.size());
  CharacterState rest = initialState(character, character.source(-1));
  for (std::size_t m = 0; m < rig.motions.size(); ++m) {
    const int motion = character.findMotion(rig.motions[m].name);
    ASSERT_GE(motion, 0);
    CharacterState state;
    std::vector<Transform> world;
    for (const double time : {0.0, 0.31, 0.77}) {
      state.time_s = time;
      poseLayers(character, character.source(motion), true, state);
      poseRig(rig, static_cast<int>(m), time, world);
      for (std::size_t j = 0; j < rig.joints.size(); ++j) {
        const std::size_t k = character.skeleton().find(rig.joints[j].name).index();
        // Both went the same way from rest.
        const Transform moved =
            state.skeleton.joint_world[k] * rest.skeleton.joint_world[k].inverse();
        const Transform expected = world[j] * rig.joints[j].rest_world.inverse();
        EXPECT_LT((moved.rotation - expected.rotation).norm(), 1e-5) << rig.joints[j].name;
        EXPECT_LT((moved.translation_m - expected.translation_m).norm(), 1e-5 * rig.size_m())
            << rig.joints[j].name;
      }
    }
  }
}

}  // namespace
}  // namespace fascia
