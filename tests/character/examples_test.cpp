// Every file in examples/ is a test case.
#include <gtest/gtest.h>

#include <fascia/base/parallel.h>
#include <fascia/math/ode/integrators.h>

#include "examples.h"
#include "small_character.h"

namespace fascia {
namespace {

using test::hashAfter;

class Examples : public testing::TestWithParam<std::string> {
 protected:
  Character load(int columns, int rows, const std::string& integrator = "") const {
    return test::loadExample(GetParam(), columns, rows, integrator);
  }
};

TEST_P(Examples, HaveTheSameBitsOnAnyNumberOfThreads) {
  for (const int side : {24, 72}) {
    const Character character = load(side, side);
    std::uint64_t hash[3];
    for (int n = 0; n < 3; ++n) {
      const ThreadLimit limit(1 << n);
      hash[n] = hashAfter(character, 10);
    }
    EXPECT_EQ(hash[0], hash[1]) << side;
    EXPECT_EQ(hash[0], hash[2]) << side;
  }
}

TEST_P(Examples, HaveTheSameBitsOnAnyNumberOfThreadsWithEveryIntegrator) {
  for (const IntegratorInfo& integrator : integrators()) {
    if (integrator.name == "euler") continue;  // refuses such skins
    const Character character = load(8, 12, std::string(integrator.name));
    std::uint64_t hash[2];
    for (int n = 0; n < 2; ++n) {
      const ThreadLimit limit(n == 0 ? 1 : 4);
      CharacterState state;
      SkinStats stats;
      poseLayers(character, character.source(0), false, state);
      placeSkin(*character.skin(), {&state.flesh, state.skeleton.joint_world}, state.skin);
      for (int f = 0; f < 2; ++f) advance(character, character.source(0), 1.0 / 60, state, stats);
      hash[n] = hashOf(character, state);
    }
    EXPECT_EQ(hash[0], hash[1]) << integrator.name;
  }
}

TEST_P(Examples, KeepTheSkinOutsideOfTheFleshInEveryFrameOfEveryMotion) {
  const Character character = load(32, 32);
  ASSERT_GE(character.motionCount(), 2u);
  for (int m = 0; m < static_cast<int>(character.motionCount()); ++m) {
    const BoundClip& clip = character.motion(static_cast<std::size_t>(m));
    EXPECT_GE(clip.duration_s, 4);
    const int frames = static_cast<int>(std::lround(clip.duration_s * 30));
    const test::Worst worst = test::simulate(character, m, 1.0 / 30, frames);
    EXPECT_TRUE(worst.finite) << clip.name;
    EXPECT_LE(worst.penetration_m, 1e-4) << clip.name;
    EXPECT_EQ(worst.stats.repaired_points, 0u) << clip.name;
    EXPECT_LE(worst.stats.max_edge_stretch, 1.2 * character.def().skin->material.max_stretch)
        << clip.name;
    RecordProperty(clip.name + ": deepest_um", std::to_string(1e6 * worst.penetration_m));
    RecordProperty(clip.name + ": stretch", std::to_string(worst.stretch));
  }
}

TEST_P(Examples, HardlyCutTheFleshWithTheirFaces) {
  const Character character = load(32, 32);
  TriangleMesh surface;
  for (int m = 0; m < static_cast<int>(character.motionCount()); ++m) {
    CharacterState state = initialState(character, character.source(m));
    SkinStats stats;
    for (int f = 0; f < 90; ++f) {
      advance(character, character.source(m), 1.0 / 30, state, stats);
      if (f % 6 != 5) continue;
      skinSurface(*character.skin(), state.flesh, state.skin, surface);
      measureFaces(state.flesh, surface, stats);
    }
    EXPECT_LE(stats.max_face_depth_m, 3e-3 * character.skin()->size_m()) << m;
  }
}

TEST_P(Examples, SurviveATeleportOfEveryJoint) {
  CharacterDef def = readCharacterFile(GetParam()).def;
  def.skin->grid.columns = 20, def.skin->grid.rows = 24;
  def.simulation.settle_s = 0;
  MotionDef jump = test::teleport(0.1, 4, 1, 1);
  const std::vector<Key> there = jump.tracks[0].keys;
  jump.tracks.clear();
  for (const JointDef& joint : def.skeleton.joints) {
    for (const DofDef& dof : joint.dofs) {
      std::vector<Key> keys = there;
      for (Key& k : keys) k.value *= isRotation(dof.dof) ? kPi / 2 : 2;  // within its limits
      jump.tracks.push_back(test::track(joint.name, std::string(name(dof.dof)), keys));
    }
  }
  def.motions = {jump};
  const Character character(def);
  for (const double frame : {1.0 / 240, 1.0 / 60, 1.0 / 12}) {
    const test::Worst worst = test::simulate(character, 0, frame, static_cast<int>(0.5 / frame));
    EXPECT_TRUE(worst.finite) << frame;
    EXPECT_LE(worst.penetration_m, 1e-4) << frame;
    EXPECT_LE(worst.longestEdge, 4) << frame;
  }
}

INSTANTIATE_TEST_SUITE_P(Files, Examples, testing::ValuesIn(test::exampleCharacters()),
                         test::exampleName);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Examples);

}  // namespace
}  // namespace fascia
