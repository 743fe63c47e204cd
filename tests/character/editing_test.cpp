#include <fascia/character/editing.h>

#include <gtest/gtest.h>

#include <optional>

#include <fascia/math/points.h>
#include <fascia/skin/grid/grid_wrap.h>

#include "small_character.h"

namespace fascia {
namespace {

using test::smallCharacter;

constexpr double kEditedFrame_s = 1.0 / 60;

template <class Visit>
void forEachPoint(const Skin& skin, const Visit& visit) {
  for (std::size_t p = 0; p < skin.pointCount(); ++p) visit(skin.storageIndex(p));
}

double largestDifference(const Skin& skin, const VectorArray& a, const VectorArray& b) {
  double largest = 0;
  forEachPoint(skin, [&](std::size_t k) {
    largest = std::max(largest, (pointAt(a, k) - pointAt(b, k)).norm());
  });
  return largest;
}

double distanceTo(const Field& field, SolidId solid, const Vec3& p) {
  const Eigen::Vector3f x = p.cast<float>();
  Eigen::Vector3f n;
  float d = 0;
  field.evaluate(solid, {&x.x(), &x.y(), &x.z(), 1}, &d, {&n.x(), &n.y(), &n.z(), 1});
  return d;
}

void play(const Character& character, int motion, int frames, CharacterState& state) {
  SkinStats stats;
  for (int f = 0; f < frames; ++f)
    advance(character, character.source(motion), kEditedFrame_s, state, stats);
}

struct RestFlesh {
  PosedSkeleton skeleton;
  PosedFlesh flesh;
  explicit RestFlesh(const Character& c) {
    const Posture rest = c.skeleton().restPosture();
    c.skeleton().pose(rest, skeleton);
    c.flesh().pose(rest, skeleton, {}, flesh);
  }
};

TEST(Editing, SharesEveryPartWhenNothingIsChanged) {
  const Character a(smallCharacter()), b = a.edited(a.def());
  EXPECT_EQ(a.parts().skeleton, b.parts().skeleton);
  EXPECT_EQ(a.parts().flesh, b.parts().flesh);
  EXPECT_EQ(a.parts().skin, b.parts().skin);
  EXPECT_EQ(a.parts().clips, b.parts().clips);
}

TEST(Editing, BuildsOnlyWhatDependsOnTheSliceThatChanged) {
  const Character a(smallCharacter());
  const SkinParts& before = a.skin()->parts();
  const auto editedBy = [&](auto change) {
    CharacterDef def = a.def();
    change(def);
    return a.edited(def);
  };
  const Character tissue = editedBy([](CharacterDef& d) { d.skin->tissue.damping_Ns_per_m3 = 9; });
  EXPECT_EQ(tissue.skin()->parts().shape, before.shape);
  EXPECT_EQ(tissue.skin()->parts().topology, before.topology);
  EXPECT_EQ(tissue.skin()->parts().attachment, before.attachment);
  EXPECT_NE(tissue.skin()->parts().points, before.points);

  const Character material =
      editedBy([](CharacterDef& d) { d.skin->material.shear_N_per_m = 100; });
  EXPECT_EQ(material.skin()->parts().shape, before.shape);
  EXPECT_NE(material.skin()->parts().topology, before.topology);

  const Character motion = editedBy([](CharacterDef& d) { d.motions[0].duration_s = 3; });
  EXPECT_EQ(motion.parts().skin, a.parts().skin);
  EXPECT_NE(motion.parts().clips[0], a.parts().clips[0]);

  const Character joint =
      editedBy([](CharacterDef& d) { d.skeleton.joints[1].offset_m.y() = 0.27; });
  EXPECT_EQ(joint.parts().flesh, a.parts().flesh);
  EXPECT_EQ(joint.parts().clips, a.parts().clips);
  EXPECT_NE(joint.skin()->parts().shape, before.shape);
  EXPECT_EQ(joint.skin()->parts().gridRest->wrap, before.gridRest->wrap);
}

TEST(Editing, GivesTheBitsOfAFreshBuildWhereTheRestShapeStays) {
  CharacterDef def = smallCharacter();
  const Character start(def);
  def.skin->material.stretch_u_N_per_m = 300;
  def.skin->material.density_kg_per_m2 = 3;
  def.skin->tissue.stiffness_N_per_m3 = 2500;
  SkinRegionDef& front = def.skin->regions.emplace_back();
  front.v_max = 0.5;
  front.edits = {{SkinQuantity::drag}};
  def.motions[0].duration_s = 2.5;
  EXPECT_EQ(test::hashAfter(start.edited(def), 20), test::hashAfter(Character(def), 20));
  EXPECT_NE(test::hashAfter(start, 20), test::hashAfter(Character(def), 20));
}

TEST(Editing, AndUndoingComesBackToTheSameBits) {
  const Character start(smallCharacter());
  CharacterDef def = start.def();
  def.flesh.solids[1].position_m.x() += 0.03;
  def.skin->fat.thickness_m = 0.02;
  def.skeleton.joints[2].offset_m.y() += 0.05;
  const Character there = start.edited(def), back = there.edited(start.def());
  EXPECT_FALSE(test::sameBits(there.skin()->restPosition(), start.skin()->restPosition()));
  EXPECT_TRUE(test::sameBits(back.skin()->restPosition(), start.skin()->restPosition()));
  EXPECT_EQ(test::hashAfter(back, 10), test::hashAfter(start, 10));
}

TEST(Editing, DoesNotDependOnTheWayToADefinition) {
  const Character start(smallCharacter());
  CharacterDef a = start.def(), b = start.def();
  a.flesh.solids[0].solid.parameters = {0.3};
  b.flesh.solids[2].position_m.z() = 0.04;
  b.skin->fat.thickness_m = 0.015;
  EXPECT_EQ(test::hashAfter(start.edited(a).edited(b), 10), test::hashAfter(start.edited(b), 10));
}

TEST(Editing, MovesARestShapeWithAllOfItsJoints) {
  const Character start(smallCharacter());
  CharacterDef def = start.def();
  const Vec3 way(0.4, -0.2, 0.1);
  def.skeleton.joints[0].offset_m += way;
  const Character moved = start.edited(def);
  forEachPoint(*start.skin(), [&](std::size_t k) {
    const Vec3 expected = pointAt(start.skin()->restPosition(), k) + way;
    EXPECT_LT((pointAt(moved.skin()->restPosition(), k) - expected).norm(), 2e-6);
  });
}

TEST(Editing, LetsTheRestShapeFollowASolidAndStayOutsideOfTheFlesh) {
  const Character start(smallCharacter());
  CharacterDef def = start.def();
  def.flesh.solids[0].solid.parameters = {0.3};
  def.flesh.solids[1].position_m += Vec3(0.06, 0, 0);
  const Character edited = start.edited(def);
  const RestFlesh rest(edited);
  const Skin& skin = *edited.skin();
  const GridLayout& g = skin.grid()->layout();
  EXPECT_GT(largestDifference(skin, skin.restPosition(), start.skin()->restPosition()), 0.03);
  for (int j = 1; j + 1 < g.rows; ++j)
    for (int i = 0; i < g.columns; ++i)
      for (std::int64_t s = 0; s < 3; ++s)
        EXPECT_GT(distanceTo(rest.flesh, SolidId(s), pointAt(skin.restPosition(), g.at(i, j))),
                  def.skin->fat.thickness_m - 1e-4);
}

TEST(Editing, KeepsStrandsOnTheSurfaceOfASolidThatIsResized) {
  const Character start(smallCharacter());
  CharacterDef def = start.def();
  def.flesh.solids[0].solid.parameters = {0.31};
  const Character edited = start.edited(def);
  const RestFlesh rest(edited);
  ASSERT_EQ(edited.skin()->grid()->anchors().anchors().size(),
            start.skin()->grid()->anchors().anchors().size());
  int onBelly = 0;
  for (const TissueAnchors::Anchor& a : edited.skin()->grid()->anchors().anchors()) {
    const Vec3 inner = rest.flesh.worldFromMaterial(a.solid, a.material);
    EXPECT_LT(std::abs(distanceTo(rest.flesh, a.solid, inner)), 2e-4);
    onBelly += a.solid == SolidId(0);
  }
  EXPECT_GT(onBelly, 20);
}

TEST(Editing, WrapsAnewWhereSolidsComeOrGo) {
  const Character start(smallCharacter());
  CharacterDef def = start.def();
  def.flesh.solids.push_back(test::ball("tail", "hip", -0.2, 0.1));
  EXPECT_EQ(test::hashAfter(start.edited(def), 10), test::hashAfter(Character(def), 10));
}

TEST(Editing, LeavesTheSkinWhereItIs) {
  const Character start(smallCharacter());
  CharacterState state = initialState(start, start.source(0));
  play(start, 0, 30, state);
  CharacterDef def = start.def();
  def.skin->fat.thickness_m = 0.02;
  def.flesh.solids[1].position_m.z() += 0.03;
  const Character edited = start.edited(def);
  CharacterState after = carryOver(start, state, edited);
  EXPECT_TRUE(test::sameBits(after.skin.position, state.skin.position));
  EXPECT_TRUE(test::sameBits(after.skin.velocity, state.skin.velocity));
  const VectorArray before = after.skin.position;
  play(edited, 0, 1, after);
  // Contact must move points out of a solid that was moved into them by 3 cm, and no farther.
  EXPECT_LT(largestDifference(*edited.skin(), before, after.skin.position), 0.08);
}

TEST(Editing, TakesTheSkinAlongWithFleshThatIsMovedFar) {
  const Character start(smallCharacter());
  CharacterState state = initialState(start, start.source(-1));
  CharacterDef def = start.def();
  def.skeleton.joints[0].offset_m += Vec3(3, 0, 0);  // farther than the body is large
  def.flesh.solids[2].position_m.z() += 0.2;         // the head through the skin
  const Character edited = start.edited(def), fresh(def);
  state = carryOver(start, state, edited);
  SkinStats stats;
  for (int f = 0; f < 120; ++f) {
    advance(edited, edited.source(-1), kEditedFrame_s, state, stats);
    measureSkin(*edited.skin(), {&state.flesh, state.skeleton.joint_world}, state.skin, stats);
  }
  EXPECT_EQ(stats.repaired_points, 0u);
  EXPECT_LT(stats.max_penetration_m, 1e-4);
  EXPECT_LT(edited.skin()->grid()->elastic().maxStretch(state.skin.position), 2.5);
  // Every point is near the flesh that it is tied to: none is held on the wrong side.
  for (const TissueAnchors::Anchor& a : edited.skin()->grid()->anchors().anchors())
    EXPECT_LT(
        (pointAt(state.skin.position, a.point) - state.flesh.worldFromMaterial(a.solid, a.material))
            .norm(),
        0.2);
}

TEST(Editing, GoesOnBitForBitWhenNothingOfTheCharacterChanged) {
  const Character start(smallCharacter());
  CharacterState a = initialState(start, start.source(0));
  play(start, 0, 20, a);
  CharacterDef def = start.def();
  def.description = "another text";
  const Character edited = start.edited(def);
  CharacterState b = carryOver(start, a, edited);
  play(start, 0, 20, a);
  play(edited, 0, 20, b);
  EXPECT_EQ(hashOf(start, a), hashOf(edited, b));
}

TEST(Editing, ComesToRestWhereAFreshCharacterDoes) {
  CharacterDef def = smallCharacter();
  def.skin->material.drag_Ns_per_m3 = 40;
  const Character start(def);
  CharacterState state = initialState(start, start.source(-1));
  def.skin->tissue.stiffness_N_per_m3 = 1500;
  def.skin->material.density_kg_per_m2 = 8;
  const Character edited = start.edited(def), fresh(def);
  state = carryOver(start, state, edited);
  CharacterState other = initialState(fresh, fresh.source(-1));
  EXPECT_GT(largestDifference(*fresh.skin(), state.skin.position, other.skin.position), 1e-3);
  play(edited, -1, 240, state);
  play(fresh, -1, 240, other);
  EXPECT_LT(largestDifference(*fresh.skin(), state.skin.position, other.skin.position), 5e-4);
}

TEST(Editing, ResamplesTheSkinToAnotherGridWhileItMoves) {
  const Character start(smallCharacter());
  CharacterState state = initialState(start, start.source(0));
  play(start, 0, 20, state);
  CharacterDef def = start.def();
  def.skin->grid.columns = 24, def.skin->grid.rows = 31;  // shares every second row and column
  const Character edited = start.edited(def);
  const CharacterState after = carryOver(start, state, edited);
  const GridLayout &g = start.skin()->grid()->layout(), &h = edited.skin()->grid()->layout();
  EXPECT_LT(
      (pointAt(after.skin.position, h.at(6, 10)) - pointAt(state.skin.position, g.at(3, 5))).norm(),
      1e-6);
  EXPECT_LT(
      (pointAt(after.skin.velocity, h.at(6, 10)) - pointAt(state.skin.velocity, g.at(3, 5))).norm(),
      1e-5);
}

TEST(Editing, TakesAFineSkinThatRidesOnACoarseOneAlong) {
  const Character start(test::fineCharacter(64));
  ASSERT_NE(start.skin()->coarse(), nullptr);
  CharacterState state = initialState(start, start.source(0));
  play(start, 0, 5, state);
  CharacterDef def = start.def();
  def.flesh.solids[1].position_m.x() += 0.01;
  const Character edited = start.edited(def);
  CharacterState after = carryOver(start, state, edited);
  ASSERT_EQ(after.skin.coarse.size(), 1u);
  EXPECT_TRUE(test::sameBits(after.skin.coarse[0].position, state.skin.coarse[0].position));
  // And one whose waves need no coarse grid any more goes on without.
  def.skin->material.stretch_u_N_per_m = def.skin->material.stretch_v_N_per_m = 20;
  def.skin->material.shear_N_per_m = 5;
  const Character soft = edited.edited(def);
  ASSERT_EQ(soft.skin()->coarse(), nullptr);
  CharacterState softState = carryOver(edited, after, soft);
  EXPECT_TRUE(softState.skin.coarse.empty());
  const Character again = soft.edited(start.def());
  ASSERT_NE(again.skin()->coarse(), nullptr);
  CharacterState last = carryOver(soft, softState, again);
  play(again, 0, 10, last);
  EXPECT_TRUE(test::allFinite(again, last));
  EXPECT_LT(again.skin()->grid()->elastic().maxStretch(last.skin.position), 3);
}

TEST(Editing, OfSomethingWrongThrowsAndChangesNothing) {
  const Character start(smallCharacter());
  CharacterDef def = start.def();
  def.skin->tissue.stiffness_N_per_m3 = -1;
  def.flesh.solids[0].joint = "elbow";
  EXPECT_THROW(static_cast<void>(start.edited(def)), Error);
  EXPECT_EQ(test::hashAfter(start, 5), test::hashAfter(Character(start.def()), 5));
}

TEST(Renaming, ChangesNothingButNames) {
  CharacterDef def = smallCharacter();
  def.motions[0].tracks.push_back(
      {TrackDef::Target::solid, "chest", "radius_m", {{0, 0.2}, {1, 0.22}}});
  SkinRegionDef& region = def.skin->regions.emplace_back();
  region.solid = "chest";
  region.edits = {{SkinQuantity::drag}};
  def.skin->brushes = {{SkinQuantity::fat, Vec3::Zero(), "spine", 0.1, 0.01}};
  def.skin->grid.anchors = {{0.5, 0.5, "chest", Vec3(0, 0, 0.2)}};
  const Character start(def);
  renameJoint(def, "spine", "backbone");
  renameJoint(def, "neck", "spine");  // a name that is free again
  renameSolid(def, "chest", "thorax");
  const Character renamed = start.edited(def);
  EXPECT_EQ(renamed.skin()->parts().gridRest->wrap, start.skin()->parts().gridRest->wrap);
  EXPECT_TRUE(renamed.skeleton().find("backbone").valid());
  EXPECT_EQ(test::hashAfter(renamed, 20), test::hashAfter(start, 20));
}

TEST(Renaming, RefusesWhatIsMissingTakenOrEmpty) {
  CharacterDef def = smallCharacter();
  const CharacterDef before = def;
  EXPECT_THROW(renameJoint(def, "elbow", "knee"), Error);
  EXPECT_THROW(renameJoint(def, "hip", "neck"), Error);
  EXPECT_THROW(renameJoint(def, "hip", ""), Error);
  EXPECT_THROW(renameSolid(def, "tail", "fin"), Error);
  EXPECT_THROW(renameSolid(def, "belly", "head"), Error);
  EXPECT_EQ(def, before);
}

TEST(HeldParameters, CountMoreThanDriversAndNeedNoEdit) {
  const Character character(smallCharacter());
  CharacterState state = initialState(character, character.source(0));
  const SolidId head = character.flesh().find("head");
  for (int f = 0; f < 10; ++f) {
    state.held = {{head, 0, 0.15 + 0.002 * f, 0.12}};
    play(character, 0, 1, state);
    EXPECT_NEAR(state.flesh.rigid().solid(head).parameter(0), 0.15 + 0.002 * f, 1e-12);
  }
  EXPECT_TRUE(test::allFinite(character, state));
  state.held = {{SolidId(77), 0, 1, 0}};  // ignored
  play(character, 0, 1, state);
  EXPECT_TRUE(test::allFinite(character, state));
}

TEST(CharacterState, OfAnotherCharacterIsRefusedAndStays) {
  CharacterDef other = smallCharacter();
  other.skin->grid.columns = 20;
  const Character a(smallCharacter()), b(other);
  CharacterState state = initialState(a, a.source(0));
  play(a, 0, 3, state);
  const std::uint64_t before = hashOf(a, state);
  EXPECT_THROW(play(b, 0, 1, state), Error);
  EXPECT_EQ(hashOf(a, state), before);
}

// A skin that was built where another one has been is another skin.
TEST(CharacterState, IsNotSteppedWithASkinThatIsGone) {
  CharacterDef def = smallCharacter();
  std::optional<Character> character(std::in_place, def);
  CharacterState state = initialState(*character, character->source(0));
  play(*character, 0, 2, state);
  CharacterState copy = state;
  def.skin->material.density_kg_per_m2 = 1;
  character.emplace(def);
  play(*character, 0, 5, state);
  play(*character, 0, 5, copy);  // a copy starts without a workspace
  EXPECT_EQ(hashOf(*character, state), hashOf(*character, copy));
}

TEST(SoftEditing, KeepsTheShapesOfBodies) {
  CharacterDef def = smallCharacter();
  def.flesh.solids[2].drivers.clear();
  def.flesh.solids[2].soft.emplace();
  const Character start(def);
  CharacterState state = initialState(start, start.source(0));
  play(start, 0, 20, state);
  def.flesh.solids[2].soft->rigidity_Pa *= 3;
  def.flesh.solids[0].position_m.x() += 0.01;
  const Character edited = start.edited(def);
  ASSERT_NE(edited.softFlesh(), start.softFlesh());
  CharacterState after = carryOver(start, state, edited);
  const std::vector<double> before = start.softFlesh()->shapes(state.bodies),
                            now = edited.softFlesh()->shapes(after.bodies);
  ASSERT_EQ(before.size(), now.size());
  for (std::size_t i = 0; i < now.size(); ++i) EXPECT_NEAR(before[i], now[i], 1e-9);
  play(edited, 0, 20, after);
  EXPECT_TRUE(test::allFinite(edited, after));
  // Rigid solids may change without new bodies, and soft ones become rigid.
  def.flesh.solids[0].position_m.x() = 0;
  const Character moved = edited.edited(def);
  EXPECT_EQ(moved.softFlesh(), edited.softFlesh());
  def.flesh.solids[2].soft.reset();
  const Character rigid = moved.edited(def);
  CharacterState last = carryOver(moved, carryOver(edited, after, moved), rigid);
  play(rigid, 0, 5, last);
  EXPECT_TRUE(test::allFinite(rigid, last));
}

}  // namespace
}  // namespace fascia
