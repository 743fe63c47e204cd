// Characters whose skin is an imported mesh, edited while they move. FASCIA_EDITS=10000 makes so
// many edits of each.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include <fascia/math/points.h>
#include <fascia/skin/mesh/mesh_rest.h>
#include <fascia/skin/mesh/rigged_skin.h>

#include "fleshed_rig.h"
#include "random_edits.h"
#include "skin/mesh_arm.h"
#include "small_character.h"
#include "support/assets.h"

namespace fascia {
namespace {

constexpr double kRigFrame_s = 1.0 / 30;

int rigEditCount(int usual) {
  const char* wanted = std::getenv("FASCIA_EDITS");
  return wanted ? std::atoi(wanted) : usual;
}

// An arm that waves.
CharacterDef wavingArm() {
  test::MeshArm arm(16, 24);
  CharacterDef def;
  def.name = "arm";
  def.skeleton = arm.skeletonDef;
  def.flesh = arm.fleshDef;
  def.rig = RigDef{"arm.glb", 1, std::make_shared<const RiggedModel>(arm.rig)};
  def.skin = arm.skinDef;
  def.skin->mesh.pose.simulate = false;
  def.skin->mesh.pose.jiggle = 0.6;
  MotionDef wave{"wave", 1, true, {}};
  wave.tracks = {test::track("upper", "ty", {{0, 0}, {0.3, 0.2}, {1, 0}}),
                 test::track("fore", "rz", {{0, 0}, {0.5, 1.2}, {1, 0}})};
  def.motions = {wave};
  def.simulation.settle_s = 0.1;
  return def;
}

bool allFiniteRig(const CharacterState& state) {
  const auto finite = [](const FloatArray& a) {
    return std::all_of(a.begin(), a.end(), [](float v) { return std::isfinite(v); });
  };
  const VectorArray& r = state.skin.position;
  return finite(r.x) && finite(r.y) && finite(r.z);
}

// Points by their number in the mesh, whatever order the skin has them in.
Vec3 meshPoint(const Character& c, const CharacterState& state, std::size_t point) {
  return pointAt(state.skin.position, c.skin()->parts().meshRest->storageOf[point]);
}

double farthestPoint(const Character& a, const CharacterState& x, const Character& b,
                     const CharacterState& y) {
  double farthest = 0;
  for (std::size_t p = 0; p < a.skin()->pointCount(); ++p)
    farthest = std::max(farthest, (meshPoint(a, x, p) - meshPoint(b, y, p)).norm());
  return farthest;
}

const PoseSkin* poseSkinOf(const Character& c) {
  return c.skin()->rigged()->skin.get();
}

Character editedArm(const Character& start, const std::function<void(CharacterDef&)>& change) {
  CharacterDef def = start.def();
  change(def);
  return start.edited(def);
}

TEST(RigEditing, KeepsThePoseFunctionWhereNoDialChanges) {
  const Character start(wavingArm());
  using Change = void (*)(CharacterDef&);
  for (const Change change :
       {Change([](CharacterDef& d) { d.skin->material.shear_N_per_m = 3; }),
        Change([](CharacterDef& d) { d.skin->tissue.damping_Ns_per_m3 = 9; }),
        Change([](CharacterDef& d) { d.skin->fat.thickness_m = 0.01; }),
        Change([](CharacterDef& d) { d.flesh.solids[0].position_m.y() += 0.004; })}) {
    const Character edited = editedArm(start, change);
    EXPECT_NE(edited.skin(), start.skin());
    EXPECT_EQ(poseSkinOf(edited), poseSkinOf(start));
    EXPECT_EQ(edited.skin()->parts().shape, start.skin()->parts().shape);
  }
  const Character tissue =
      editedArm(start, [](CharacterDef& d) { d.skin->tissue.damping_Ns_per_m3 = 9; });
  EXPECT_EQ(tissue.skin()->parts().meshRest, start.skin()->parts().meshRest);
  EXPECT_EQ(tissue.skin()->parts().topology, start.skin()->parts().topology);
  const Character muscle = editedArm(start, [](CharacterDef& d) { d.skin->mesh.pose.muscle = 1; });
  EXPECT_NE(poseSkinOf(muscle), poseSkinOf(start));
  EXPECT_EQ(&poseSkinOf(muscle)->mesh(), &poseSkinOf(start)->mesh());
  EXPECT_EQ(&poseSkinOf(muscle)->jiggle(), &poseSkinOf(start)->jiggle());
  const Character joint =
      editedArm(start, [](CharacterDef& d) { d.skeleton.joints[1].offset_m.x() += 0.01; });
  EXPECT_NE(&poseSkinOf(joint)->mesh(), &poseSkinOf(start)->mesh());
}

TEST(RigEditing, LetsTheFleshSwingOnWhereItIs) {
  const Character start(wavingArm());
  CharacterState state = initialState(start, start.source(0));
  SkinStats stats;
  for (int f = 0; f < 12; ++f) advance(start, start.source(0), kRigFrame_s, state, stats);
  ASSERT_GT(state.skin.jiggle.offset.size(), 2u);
  ASSERT_GT(state.skin.jiggle.offset[0].norm(), 1e-4f);
  // What does not concern it leaves every bit of it.
  const Character tissue =
      editedArm(start, [](CharacterDef& d) { d.skin->tissue.damping_Ns_per_m3 = 9; });
  CharacterState a = carryOver(start, state, tissue), b = state;
  advance(tissue, tissue.source(0), kRigFrame_s, a, stats);
  advance(start, start.source(0), kRigFrame_s, b, stats);
  EXPECT_EQ(hashOf(tissue, a), hashOf(start, b));
  // Another dial: the same places go on with their offsets.
  const Character livelier =
      editedArm(start, [](CharacterDef& d) { d.skin->mesh.pose.jiggle = 0.8; });
  const CharacterState c = carryOver(start, state, livelier);
  EXPECT_EQ(c.skin.jiggle.offset, state.skin.jiggle.offset);
  EXPECT_EQ(c.skin.jiggle.velocity, state.skin.jiggle.velocity);
}

TEST(RigEditing, GoesOnFromWhereItIsWhenPointsAreFixedOrTheMembraneComes) {
  CharacterDef def = wavingArm();
  def.skin->mesh.pose.simulate = true;
  const Character start(def);
  CharacterState state = initialState(start, start.source(0));
  SkinStats stats;
  for (int f = 0; f < 12; ++f) advance(start, start.source(0), kRigFrame_s, state, stats);
  // The bead is simulated, too: other points come first in memory.
  const Character bead = editedArm(start, [](CharacterDef& d) {
    d.skin->mesh.parts = {{"bead", false}};
  });
  ASSERT_NE(bead.skin()->parts().meshRest->order, start.skin()->parts().meshRest->order);
  const CharacterState after = carryOver(start, state, bead);
  EXPECT_EQ(farthestPoint(start, state, bead, after), 0);
  EXPECT_TRUE(after.skin.ready);
  const Character posed =
      editedArm(bead, [](CharacterDef& d) { d.skin->mesh.pose.simulate = false; });
  CharacterState still = carryOver(bead, after, posed);
  EXPECT_EQ(farthestPoint(start, state, posed, still), 0);
  advance(posed, posed.source(0), kRigFrame_s, still, stats);
  CharacterState again = carryOver(posed, still, start);
  EXPECT_EQ(farthestPoint(posed, still, start, again), 0);
  advance(start, start.source(0), kRigFrame_s, again, stats);
  EXPECT_TRUE(allFiniteRig(again));
}

// Edits `start` while it moves. A rig's skin has no history: what editing has made must have every
// bit of what is built afresh.
void fuzzRig(const CharacterDef& first, int count, int compareEvery) {
  Character character(first);
  test::RandomEdits edits(first, 11);
  CharacterState state = initialState(character, character.source(0));
  SkinStats stats;
  for (int n = 0; n < count; ++n) {
    CharacterDef next = character.def();
    const std::string what = edits.apply(next);
    SCOPED_TRACE("edit " + std::to_string(n) + ": " + what);
    const Character edited = character.edited(next);
    CharacterState after = carryOver(character, state, edited);
    // The skin stands where it stood.
    ASSERT_EQ(farthestPoint(character, state, edited, after), 0);
    character = edited;
    state = std::move(after);
    for (int f = 0; f < 1 + n % 3; ++f)
      advance(character, character.source(0), kRigFrame_s, state, stats);
    ASSERT_TRUE(allFiniteRig(state));
    ASSERT_LT(character.skin()->topology().maxStretch(state.skin.position), 30);
    if (n % compareEvery != compareEvery - 1) continue;
    ASSERT_EQ(test::hashAfter(character, 4), test::hashAfter(Character(next), 4));
  }
  EXPECT_LE(stats.repaired_points, static_cast<std::uint64_t>(count / 50));
}

// A character whose rig brings a motion and whose flesh, skin and motions refer to a joint.
CharacterDef nodding() {
  CharacterDef def = wavingArm();
  SkinRegionDef& region = def.skin->regions.emplace_back();
  region.joint = "fore";
  region.edits = {{SkinQuantity::jiggle}};
  def.skin->brushes = {{SkinQuantity::muscle, Vec3::Zero(), "fore", 0.1, 0.3}};
  return def;
}

TEST(RigRenaming, KeepsReferencesAndEveryBit) {
  const Character start(nodding());
  CharacterDef def = start.def();
  renameJoint(def, "fore", "forearm");
  ASSERT_EQ(def.rig->joint_names.size(), 1u);
  EXPECT_EQ(def.rig->joint_names[0].joint, "fore");
  const Character renamed = start.edited(def);
  EXPECT_TRUE(renamed.skeleton().find("forearm").valid());
  EXPECT_FALSE(renamed.skeleton().find("fore").valid());
  EXPECT_EQ(poseSkinOf(renamed), poseSkinOf(start));
  EXPECT_EQ(test::hashAfter(renamed, 8), test::hashAfter(start, 8));
  EXPECT_EQ(test::hashAfter(Character(def), 8), test::hashAfter(start, 8));
}

TEST(RigRenaming, GoesOnWhileItMoves) {
  const Character start(nodding());
  CharacterState a = initialState(start, start.source(0));
  SkinStats stats;
  for (int f = 0; f < 8; ++f) advance(start, start.source(0), kRigFrame_s, a, stats);
  CharacterDef def = start.def();
  renameJoint(def, "upper", "fore_");
  renameJoint(def, "fore", "upper");  // a name that is free again, and another joint's in the file
  const Character renamed = start.edited(def);
  CharacterState b = carryOver(start, a, renamed);
  for (int f = 0; f < 8; ++f) {
    advance(start, start.source(0), kRigFrame_s, a, stats);
    advance(renamed, renamed.source(0), kRigFrame_s, b, stats);
  }
  EXPECT_EQ(hashOf(renamed, b), hashOf(start, a));
}

TEST(RigRenaming, BackIsAsIfNothingHadBeen) {
  const CharacterDef before = nodding();
  CharacterDef def = before;
  renameJoint(def, "fore", "forearm");
  renameJoint(def, "forearm", "arm");
  ASSERT_EQ(def.rig->joint_names.size(), 1u);
  renameJoint(def, "arm", "fore");
  EXPECT_EQ(def, before);
}

TEST(RigRenaming, OfAFoxPlaysTheMotionsOfItsFile) {
  const auto file = assetFile("mesh2motion-cc0/fox-animations.glb");
  if (!file) GTEST_SKIP() << "the shared assets are not here";
  const Character start(test::fleshOut(file->string()));
  CharacterDef def = start.def();
  const std::string old = def.rig->model->joints.back().name;
  renameJoint(def, old, "the last one");
  const Character renamed = start.edited(def);
  ASSERT_EQ(renamed.motionCount(), start.motionCount());
  EXPECT_EQ(poseSkinOf(renamed), poseSkinOf(start));
  EXPECT_EQ(test::hashAfter(renamed, 4), test::hashAfter(start, 4));
}

TEST(RigRenaming, OfJointsThatTheFileLacksIsOneFault) {
  CharacterDef def = nodding();
  def.rig->joint_names = {{"elbow", "fore"}};
  try {
    const Character character(def);
    FAIL();
  } catch (const Error& error) {
    ASSERT_EQ(error.issues().size(), 1u);
    EXPECT_EQ(error.issues()[0].where.pointer, "/rig/joint_names/0/joint");
  }
}

TEST(RigEditing, OfAnArmStaysWholeAndGivesTheBitsOfAFreshBuild) {
  fuzzRig(wavingArm(), rigEditCount(90), 4);
}

TEST(RigEditing, OfAFoxStaysWholeAndGivesTheBitsOfAFreshBuild) {
  const auto file = assetFile("mesh2motion-cc0/fox-animations.glb");
  if (!file) GTEST_SKIP() << "the shared assets are not here";
  fuzzRig(test::fleshOut(file->string()), rigEditCount(20), 8);
}

}  // namespace
}  // namespace fascia
