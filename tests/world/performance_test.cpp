#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fascia/base/parallel.h>
#include <fascia/world/stage_recording.h>
#include <fascia/world/stage_surface.h>

#include "character/small_character.h"
#include "scenes.h"

namespace fascia {
namespace {

Vec3 pointOf(const Stage& stage, const Performance& performance, const std::string& name) {
  return stage.bodies().point(performance.bodies().r, *stage.findPoint(name));
}

SceneDef fallingBall() {
  SceneDef def;
  def.bodies = {test::ball("ball", Vec3(0, 2, 0))};
  return def;
}

TEST(Performance, AFreeBodyFallsAsImplicitEulerSaysItDoes) {
  const Stage stage(fallingBall());
  Performance performance(stage);
  test::run(performance, 0.5);
  EXPECT_DOUBLE_EQ(performance.time_s(), 0.5);
  // Σ h² g i over n steps: g t (t + h) / 2.
  const double h_s = 1.0 / 120, expected = 2 - 0.5 * 9.81 * 0.5 * (0.5 + h_s);
  EXPECT_NEAR(pointOf(stage, performance, "ball").y(), expected, 1e-6);
}

TEST(Performance, GroundAndPropsStopWhatFalls) {
  SceneDef def = fallingBall();
  def.ground = GroundDef{.height_m = 0.5};
  def.bodies.push_back(test::ball("other", Vec3(3, 2, 0)));
  def.props.emplace_back().name = "table";
  def.props[0].solid.shape = "superellipsoid";
  def.props[0].solid.parameters = {1, 0.1, 1, 0.2, 0.2};
  def.props[0].position_m = Vec3(3, 1, 0);
  for (SceneBodyDef& body : def.bodies) body.rigidity_Pa = 1e5, body.volume_Pa = 2e5;
  const Stage stage(def);
  Performance performance(stage);
  test::run(performance, 2);
  EXPECT_NEAR(pointOf(stage, performance, "ball").y(), 0.7, 0.02);
  EXPECT_NEAR(pointOf(stage, performance, "other").y(), 1.3, 0.02);
}

TEST(Performance, BodiesThatDoNotCollideFallThrough) {
  SceneDef def = fallingBall();
  def.ground = GroundDef{};
  def.bodies[0].collides = false;
  const Stage stage(def);
  Performance performance(stage);
  test::run(performance, 1);
  EXPECT_LT(pointOf(stage, performance, "ball").y(), -1);
}

TEST(Performance, ConstraintsTiePointsFromTheStart) {
  SceneDef def = fallingBall();
  def.places = {{"hook", Vec3(0.5, 3, 0)}};
  def.constraints.push_back({"", SceneConstraintDef::Kind::rod, {"ball.top", "hook"}});
  const Stage stage(def);
  const double length = (Vec3(0, 2.2, 0) - Vec3(0.5, 3, 0)).norm();
  Performance performance(stage);
  for (int i = 0; i < 120; ++i) {
    performance.advance(1.0 / 60);
    EXPECT_NEAR((pointOf(stage, performance, "ball.top") - Vec3(0.5, 3, 0)).norm(), length, 1e-6);
  }
}

TEST(Performance, AStartThatBreaksItsConstraintsIsMadeLegal) {
  SceneDef def = fallingBall();
  def.bodies.push_back(test::ball("other", Vec3(0, 2.5, 0)));
  def.constraints.push_back({"", SceneConstraintDef::Kind::attach, {"ball.top", "other"}});
  const Stage stage(def);
  const Performance performance(stage);
  EXPECT_NEAR(
      (pointOf(stage, performance, "ball.top") - pointOf(stage, performance, "other")).norm(), 0,
      1e-9);
}

TEST(Performance, FollowsKeyframedPaths) {
  SceneDef def = fallingBall();
  def.paths.push_back(
      {"ball.top", {{0.5, Vec3(0, 2, 0), {}, {}}, {1, Vec3(1, 2, 0), {}, {}}}, 0.25});
  const Stage stage(def);
  Performance performance(stage);
  test::run(performance, 0.5);
  EXPECT_NEAR((pointOf(stage, performance, "ball.top") - Vec3(0, 2, 0)).norm(), 0, 1e-6);
  test::run(performance, 0.5);
  EXPECT_NEAR((pointOf(stage, performance, "ball.top") - Vec3(1, 2, 0)).norm(), 0, 1e-6);
}

TEST(Performance, TheScriptDrivesItAndItsErrorsNameTheLine) {
  SceneDef def = fallingBall();
  def.script = "act.lua";
  def.script_text = "move('ball.top', {1, 3, 0}, 0.5)\nsucceed()\n";
  {
    const Stage stage(def);
    Performance performance(stage);
    test::run(performance, 0.6);
    EXPECT_EQ(performance.script()->outcome(), ScriptOutcome::succeeded);
    EXPECT_NEAR((pointOf(stage, performance, "ball.top") - Vec3(1, 3, 0)).norm(), 0, 1e-6);
  }
  def.script_text = "wait(0.1)\nhold('bal.top')\n";
  const Stage stage(def);
  Performance performance(stage);
  try {
    test::run(performance, 1);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.issues().front().where.file, "act.lua");
    EXPECT_EQ(error.issues().front().where.line, 2);
  }
}

// A crowd with contact, a script and random numbers.
SceneDef heap() {
  SceneDef def;
  def.ground = GroundDef{};
  for (int i = 0; i < 12; ++i) {
    def.bodies.push_back(
        test::ball("b" + std::to_string(i), Vec3(0.1 * (i % 3), 0.3 + 0.41 * i, 0)));
    def.bodies.back().scatter.position_m = Vec3(0.05, 0, 0.05);
  }
  def.script = "act.lua";
  def.script_text = "while true do impulse('b0', vec(random(), 1, 0)) wait(0.3) end";
  return def;
}

std::uint64_t hashAfter(std::uint64_t seed, int threads) {
  const ThreadLimit limit(threads);
  const Stage stage(heap());
  Performance performance(stage, seed);
  test::run(performance, 1.5);
  return performance.hash();
}

TEST(Performance, SameBitsOnAnyNumberOfThreadsAndOthersFromOtherSeeds) {
  const std::uint64_t hash = hashAfter(3, 1);
  EXPECT_EQ(hashAfter(3, 4), hash);
  EXPECT_NE(hashAfter(4, 4), hash);
}

// A character that does nothing but stand, as something to fall on and to hold on to.
SceneDef withDoll() {
  SceneDef def = fallingBall();
  CharacterDef doll = test::smallCharacter();
  doll.skin.reset();
  SceneCharacterDef character;
  character.name = "doll";
  character.motion = "none";
  character.position_m = Vec3(2, 0, 1);
  character.heading_rad = kPi / 2;
  character.character = std::make_shared<const Character>(doll);
  def.characters.push_back(std::move(character));
  return def;
}

TEST(Performance, MovesACharacterByAnySource) {
  const Stage stage(withDoll());
  const Character& doll = *stage.def().characters[0].character;
  Performance performance(stage);
  const ClipSource waving = doll.source(0);
  performance.setSource(0, &waving);
  test::run(performance, 0.4);
  PostureSample wanted;
  waving.sample(performance.time_s(), wanted);
  const std::vector<double> rest = doll.skeleton().restPosture().values;
  ASSERT_NE(wanted.posture.values, rest);
  EXPECT_EQ(performance.character(0).posture.values, wanted.posture.values);
  performance.setSource(0, nullptr);
  test::run(performance, 0.1);
  EXPECT_EQ(performance.character(0).posture.values, rest);
}

TEST(Performance, BodiesLandOnCharactersWhereTheseArePlaced) {
  SceneDef def = withDoll();
  const double top = 1 + 0.5 + 0.15 + 0.15;  // hip, spine and neck, the head's centre and radius
  def.bodies[0].position_m = Vec3(2, top + 0.4, 1);
  def.bodies[0].rigidity_Pa = 1e5, def.bodies[0].volume_Pa = 2e5;
  const Stage stage(def);
  Performance performance(stage);
  double lowest = 10;
  for (int i = 0; i < 30; ++i) {
    performance.advance(1.0 / 60);
    lowest = std::min(lowest, pointOf(stage, performance, "ball").y());
  }
  EXPECT_GT(lowest, top + 0.15);
  EXPECT_LT(lowest, top + 0.25);
}

// How deep the deepest point of the doll's skin is in a ball, m; negative: outside.
double deepest(const Performance& performance, const Stage& stage, const Vec3& center_m,
               double radius_m) {
  const SceneCharacterDef& doll = stage.def().characters[0];
  TriangleMesh skin;
  const CharacterState& state = performance.character(0);
  skinSurface(*doll.character->skin(), state.flesh, state.skin, skin);
  double out = -1;
  for (const Eigen::Vector3f& p : skin.positions)
    out = std::max(out, radius_m - (placeOf(doll).point(p.cast<double>()) - center_m).norm());
  return out;
}

TEST(Performance, SkinsOnGridsAreKeptOutOfPropsAndBodies) {
  SceneDef def = withDoll();
  CharacterDef doll = test::smallCharacter();
  ASSERT_TRUE(doll.skin);
  def.characters[0].character = std::make_shared<const Character>(doll);
  const Stage bare(def);
  // Half in the belly, whose skin is about 0.25 m around the hip.
  const Vec3 beside = placeOf(def.characters[0]).point(Vec3(0, 1, 0.3));
  EXPECT_GT(deepest(Performance(bare), bare, beside, 0.12), 0.03);
  def.props.emplace_back().name = "stone";
  def.props[0].solid.shape = "sphere";
  def.props[0].solid.parameters = {0.12};
  def.props[0].position_m = beside;
  const Stage stage(def);
  Performance performance(stage);
  test::run(performance, 0.2);
  EXPECT_LT(deepest(performance, stage, beside, 0.12), 1e-3);

  // The same as a body that is held there.
  def.props.clear();
  def.bodies[0] = test::ball("ball", beside, 0.12);
  def.bodies[0].rigidity_Pa = 1e7, def.bodies[0].volume_Pa = 2e7;
  for (const char* point : {"left", "right", "front"}) def.bodies[0].points.push_back({point, {}});
  def.bodies[0].points[1].position_m = Vec3(-0.1, 0, 0);
  def.bodies[0].points[2].position_m = Vec3(0.1, 0, 0);
  def.bodies[0].points[3].position_m = Vec3(0, 0, 0.1);
  for (const char* point : {"ball.top", "ball.left", "ball.right", "ball.front"})
    def.constraints.push_back({"", SceneConstraintDef::Kind::nail, {point}});
  const Stage held(def);
  Performance second(held);
  test::run(second, 0.2);
  EXPECT_LT(deepest(second, held, beside, 0.12), 2e-3);
}

TEST(Performance, JointsOfCharactersArePlacesThatBodiesHangOn) {
  SceneDef def = withDoll();
  def.bodies[0].collides = false;
  def.script = "act.lua";
  def.script_text = "grab('ball.top', 'doll.neck', 0.5)";
  const Stage stage(def);
  Performance performance(stage);
  test::run(performance, 1.5);
  const Vec3 neck(2, 1.5, 1);
  EXPECT_NEAR((pointOf(stage, performance, "ball.top") - neck).norm(), 0, 1e-3);
}

TEST(StageRecording, KeepsEveryFrameAndStartsLate) {
  const Stage stage(fallingBall());
  const StageRecording all = record(stage, {.duration_s = 0.5});
  ASSERT_EQ(all.frames.size(), 31u);
  const StageRecording late = record(stage, {.duration_s = 0.5, .start_s = 0.4});
  ASSERT_EQ(late.frames.size(), 7u);
  EXPECT_EQ(late.frames.back().bodies, all.frames.back().bodies);
  EXPECT_EQ(late.state_hash, all.state_hash);
}

TEST(StageRecording, SurfacesAreOneMeshThatMovesAsItsParts) {
  SceneDef def = fallingBall();
  def.bodies.push_back(test::ball("other", Vec3(1, 3, 0)));
  const Stage stage(def);
  const StageRecording recording = record(stage, {.duration_s = 0.25});
  const Recording surface = surfaceRecording(stage, recording);
  const std::size_t half = stage.look(BodyId(0)).positions.size();
  ASSERT_EQ(surface.skin.positions.size(), 2 * half);
  ASSERT_EQ(surface.frames.size(), recording.frames.size());
  for (std::size_t f = 0; f < surface.frames.size(); ++f)
    for (const std::size_t v : {std::size_t{0}, half - 1}) {
      const Vec3 X = stage.look(BodyId(1)).positions[v].cast<double>();
      const Vec3 expected = stage.bodies().point(recording.frames[f].bodies, {BodyId(1), X});
      EXPECT_NEAR((surface.frames[f].skin_m[half + v].cast<double>() - expected).norm(), 0, 1e-5);
    }
}

}  // namespace
}  // namespace fascia
