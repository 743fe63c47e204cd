// Characters on rigs whose skin has morph targets: what moves weights moves the skin.
#include <fascia/character/editing.h>
#include <fascia/character/recording.h>
#include <fascia/io/state/state_file.h>
#include <fascia/math/points.h>
#include <fascia/skin/mesh/mesh_rest.h>
#include <fascia/track/blend_source.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "skin/mesh_arm.h"
#include "small_character.h"

namespace fascia {
namespace {

constexpr double kFaceFrame_s = 1.0 / 60;
const Eigen::Vector3f kOut(0, 0.02f, 0.01f);

// The arm's points near its middle come out by one morph; "dent" moves the bead's, half at rest.
RiggedModel armWithMorphs(const test::MeshArm& arm) {
  RiggedModel rig = arm.rig;
  RigMorph bulge{"bulge", -1, -1, 0, {}, {}}, dent{"dent", -1, -1, 0.5f, {}, {}};
  for (std::uint32_t p = 0; p < rig.points_m.size(); ++p) {
    RigMorph& morph = rig.component[p] == 0 ? bulge : dent;
    if (rig.component[p] == 0 && std::abs(rig.points_m[p].x() - 0.15f) > 0.05f) continue;
    morph.points.push_back(p);
    morph.displacement_m.push_back(kOut);
  }
  rig.morphs = {bulge, dent};
  return rig;
}

TrackDef weightTrack(const std::string& morph, std::vector<Key> keys) {
  return {TrackDef::Target::morph, morph, "", std::move(keys)};
}

CharacterDef armCharacter(bool simulate = false, bool withMorphs = true) {
  const test::MeshArm arm(16, 24);
  CharacterDef def;
  def.name = "arm";
  def.skeleton = arm.skeletonDef;
  def.flesh = arm.fleshDef;
  def.rig = RigDef{"arm.glb", 1,
                   std::make_shared<const RiggedModel>(withMorphs ? armWithMorphs(arm) : arm.rig)};
  def.skin = arm.skinDef;
  def.skin->mesh.pose.simulate = simulate;
  def.skin->mesh.pose.jiggle = 0;
  MotionDef lift{"lift", 2, false, {}};
  lift.tracks = {test::track("upper", "ty", {{0, 0}, {2, 0.3}}),
                 test::track("upper", "rz", {{0, 0}, {2, 0.5}})};
  if (withMorphs) lift.tracks.push_back(weightTrack("bulge", {{0, 0}, {1, 1}, {2, 0.25}}));
  def.motions = {lift};
  def.simulation.settle_s = 0.1;
  return def;
}

std::vector<Eigen::Vector3f> drawnAfter(const Character& character, const PostureSource& source,
                                        int frames) {
  CharacterState state = initialState(character, source);
  SkinStats stats;
  for (int f = 0; f < frames; ++f) advance(character, source, kFaceFrame_s, state, stats);
  TriangleMesh mesh;
  skinSurface(*character.skin(), state.flesh, state.skin, mesh);
  return mesh.positions;
}

bool isMoved(const Character& character, std::size_t morph, std::size_t vertex) {
  const RiggedModel& rig = *character.def().rig->model;
  return std::ranges::binary_search(rig.morphs[morph].points, rig.vertices[vertex].point);
}

// Of the character's points by one morph of weight w, all joints turned alike.
void expectShaped(const Character& character, const std::vector<Eigen::Vector3f>& plain,
                  const std::vector<Eigen::Vector3f>& shaped, std::size_t morph, double weight,
                  double angle_rad) {
  const Mat3 turn = Eigen::AngleAxisd(angle_rad, Vec3::UnitZ()).toRotationMatrix();
  const Eigen::Vector3f way = (weight * turn * kOut.cast<double>()).cast<float>();
  std::size_t moved = 0;
  for (std::size_t v = 0; v < plain.size(); ++v) {
    const bool is = isMoved(character, morph, v);
    moved += is ? 1 : 0;
    const Eigen::Vector3f expected = is ? way : Eigen::Vector3f(0, 0, 0);
    EXPECT_LT((shaped[v] - plain[v] - expected).norm(), 2e-6f) << v;
  }
  EXPECT_GT(moved, 10u);
}

TEST(MorphCharacter, NamesTheMorphsOfItsRig) {
  const Character character(armCharacter());
  ASSERT_EQ(character.morphs().size(), 2u);
  EXPECT_EQ(character.morphs().find("dent"), 1);
  EXPECT_EQ(character.morphs()[1].rest, 0.5);
  EXPECT_EQ(Character(armCharacter(false, false)).morphs().size(), 0u);
}

TEST(MorphCharacter, WeightsOfAClipReachTheDrawnPoints) {
  const Character with(armCharacter()), without(armCharacter(false, false));
  for (const int frame : {0, 30, 60, 90}) {
    const double time_s = frame * kFaceFrame_s;
    PostureSample sample;
    with.source(0).sample(time_s, sample);
    const double angle = sample.posture.values[3];
    expectShaped(with, drawnAfter(without, without.source(0), frame),
                 drawnAfter(with, with.source(0), frame), 0, sample.morphs.weights[0], angle);
  }
}

// Moves nothing but a weight, which somebody sets between frames.
struct Puppeteer final : PostureSource {
  explicit Puppeteer(const Character& c) : rest(c.skeleton().restPosture()) {}
  void sample(double, PostureSample& out) const override {
    out.posture = rest;
    out.parameters.clear();
    out.morphs.weights = weights;
  }
  Posture rest;
  std::vector<double> weights{0};
};

TEST(MorphCharacter, ASourceOfOnesOwnDrivesThemLive) {
  const Character character(armCharacter());
  Puppeteer hand(character);
  CharacterState state = initialState(character, hand);
  SkinStats stats;
  TriangleMesh plain, shaped;
  skinSurface(*character.skin(), state.flesh, state.skin, plain);
  for (const double weight : {0.5, -1.0, 2.0}) {
    hand.weights = {weight};
    advance(character, hand, kFaceFrame_s, state, stats);
    skinSurface(*character.skin(), state.flesh, state.skin, shaped);
    expectShaped(character, plain.positions, shaped.positions, 0, weight, 0);
  }
  // What it says of morphs that there are not, or as no number, changes nothing.
  hand.weights = {std::nan(""), 0.5, 7};
  advance(character, hand, kFaceFrame_s, state, stats);
  skinSurface(*character.skin(), state.flesh, state.skin, shaped);
  expectShaped(character, plain.positions, shaped.positions, 0, 0, 0);
}

TEST(MorphCharacter, ABlendByHalfMovesPointsHalfAsFar) {
  const Character character(armCharacter());
  Puppeteer hand(character);
  const auto plain = drawnAfter(character, hand, 1);
  hand.weights = {1};
  BlendSource blend(character.figure());
  blend.add(hand, {0.5, 0.5});
  expectShaped(character, plain, drawnAfter(character, blend, 1), 0, 0.5, 0);
}

// Points in the middle of what moves, of the simulated skin.
double meanHeight(const Character& character, const CharacterState& state) {
  const RiggedModel& rig = *character.def().rig->model;
  const std::vector<std::uint32_t>& storage = character.skin()->parts().meshRest->storageOf;
  double sum = 0;
  for (const std::uint32_t p : rig.morphs[0].points)
    sum += pointAt(state.skin.position, storage[p]).y();
  return sum / static_cast<double>(rig.morphs[0].points.size());
}

TEST(MorphCharacter, ASimulatedSkinFollowsElastically) {
  const Character character(armCharacter(true));
  Puppeteer hand(character);
  CharacterState state = initialState(character, hand);
  SkinStats stats;
  const double before = meanHeight(character, state);
  hand.weights = {1};
  advance(character, hand, kFaceFrame_s, state, stats);
  const double soon = meanHeight(character, state) - before;
  for (int f = 0; f < 120; ++f) advance(character, hand, kFaceFrame_s, state, stats);
  const double late = meanHeight(character, state) - before;
  // It swings, then comes to where its membrane lets it: most of the way.
  EXPECT_GT(soon, 0.5 * double{kOut.y()});
  EXPECT_GT(std::abs(soon - late), 1e-5);
  EXPECT_GT(late, 0.8 * double{kOut.y()});
  EXPECT_LT(late, 1.05 * double{kOut.y()});
  EXPECT_EQ(stats.repaired_points, 0u);
}

TEST(MorphCharacter, ARecordingHoldsTheWeights) {
  const Character character(armCharacter());
  RecordOptions options;
  options.duration_s = 1;
  const Recording recording = record(character, character.source(0), options);
  ASSERT_EQ(recording.frames.size(), 61u);
  EXPECT_THAT(recording.frames.front().morphs, testing::ElementsAre(0, 0.5));
  EXPECT_NEAR(recording.frames.back().morphs[0], 1, 1e-12);
}

TEST(MorphCharacter, ASavedStateGoesOnBitForBit) {
  const Character character(armCharacter());
  const ClipSource lift = character.source(0);
  CharacterState state = initialState(character, lift);
  SkinStats stats;
  for (int f = 0; f < 20; ++f) advance(character, lift, kFaceFrame_s, state, stats);
  CharacterState back = loadState(character, saveState(character, state));
  EXPECT_EQ(back.morphs.weights, state.morphs.weights);
  EXPECT_EQ(back.morphs.rates, state.morphs.rates);
  EXPECT_EQ(hashOf(character, back), hashOf(character, state));
  advance(character, lift, kFaceFrame_s, back, stats);
  advance(character, lift, kFaceFrame_s, state, stats);
  EXPECT_EQ(hashOf(character, back), hashOf(character, state));
  // Not in a character without them, nor with weights that no source could have said.
  EXPECT_THROW(loadState(Character(armCharacter(false, false)), saveState(character, state)),
               Error);
  state.morphs.weights[0] = 99;
  EXPECT_THROW(saveState(character, state), Error);
}

TEST(MorphCharacter, TheHashTellsWeightsApart) {
  const Character character(armCharacter());
  CharacterState state = initialState(character, character.source(0));
  const std::uint64_t before = hashOf(character, state);
  state.morphs.weights[1] = 0.75;
  EXPECT_NE(hashOf(character, state), before);
}

TEST(MorphCharacter, WeightsGoOnThroughAnEdit) {
  const Character start(armCharacter());
  Puppeteer hand(start);
  hand.weights = {0.7};
  CharacterState state = initialState(start, hand);
  CharacterDef def = start.def();
  def.skin->mesh.pose.tightness = 0.7;
  RiggedModel swapped = *def.rig->model;
  std::swap(swapped.morphs[0], swapped.morphs[1]);
  def.rig->model = std::make_shared<const RiggedModel>(std::move(swapped));
  const Character next = start.edited(def);
  const CharacterState after = carryOver(start, state, next);
  EXPECT_THAT(after.morphs.weights, testing::ElementsAre(0.5, 0.7));  // by their names
  const Character dial = start.edited([&] {
    CharacterDef d = start.def();
    d.skin->tissue.damping_Ns_per_m3 = 9;
    return d;
  }());
  EXPECT_EQ(dial.parts().morphs, start.parts().morphs);
  EXPECT_EQ(carryOver(start, state, dial).morphs.weights, state.morphs.weights);
}

TEST(MorphCharacter, ATrackOfAMorphThatThereIsNotIsNamedOnce) {
  CharacterDef def = armCharacter();
  def.motions[0].tracks.push_back(weightTrack("buldge", {{0, 0}}));
  try {
    const Character character(def);
    FAIL();
  } catch (const Error& error) {
    ASSERT_EQ(error.issues().size(), 1u);
    EXPECT_EQ(error.issues()[0].where.pointer, "/motions/0/tracks/3/morph");
    EXPECT_THAT(error.issues()[0].hint, testing::HasSubstr("bulge"));
  }
}

}  // namespace
}  // namespace fascia
