#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <complex>

#include <fascia/base/parallel.h>
#include <fascia/character/recording.h>

#include "small_character.h"

namespace fascia {
namespace {

using test::faults;

constexpr double kGravity = 9.81;
constexpr double kFrame_s = 1.0 / 60;

// A jelly ball in front of a hip that can shake; no skin.
CharacterDef jelly(const BodyBasisDef& basis = {}) {
  CharacterDef def;
  def.name = "jelly";
  def.skeleton.joints = {
      {"hip", "", Vec3(0, 1, 0), Vec3::Zero(), {{Dof::tx}, {Dof::ty}, {Dof::tz}, {Dof::ry}}}};
  def.flesh.solids = {test::ball("belly", "hip", 0, 0.1)};
  def.flesh.solids[0].position_m = Vec3(0, 0, 0.15);
  SoftSolidDef& soft = def.flesh.solids[0].soft.emplace();
  soft.basis = basis;
  soft.rigidity_Pa = 2e3, soft.volume_Pa = 4e3, soft.relaxation_s = 0.01;
  return def;
}

BodyBasisDef quadratic() {
  return {.kind = BodyBasisDef::Kind::polynomial};
}

// Where the middle of the solid's matter is.
Vec3 middle(const CharacterState& state, std::int64_t solid = 0) {
  return state.flesh.worldFromMaterial(SolidId(solid), Vec3::Zero());
}

void run(const Character& character, int motion, int frames, CharacterState& state) {
  SkinStats stats;
  for (int f = 0; f < frames; ++f)
    advance(character, character.source(motion), kFrame_s, state, stats);
  EXPECT_EQ(stats.repaired_points, 0u);
}

double speed(const CharacterState& state) {
  double sum = 0;
  for (const double v : state.bodies.v) sum += v * v;
  return std::sqrt(sum);
}

// Held in a plane, an affine body can shear and stretch off that plane only: x = X + a w(X) with
// w = 0 on the plane, and a moves its mass by a w(centre). Small a, µ = 4 k_e, λ = 2 k_c:
//     shear energy  µ a² V / (2 l²),  force  m g  at the distance l of the centre,
// so that the sag is m g l² / (µ V) = ρ g l² / µ for a plane at the distance l.
TEST(SoftFlesh, SagsByTheStaticSolutionAndComesToRest) {
  CharacterDef def = jelly();
  SoftSolidDef& soft = *def.flesh.solids[0].soft;
  soft.rigidity_Pa = 2e4, soft.volume_Pa = 4e4;
  const double plane_m = 0.06;  // behind the centre
  soft.held_m = {{0.05, -0.03, -plane_m}, {-0.05, -0.03, -plane_m}, {0, 0.06, -plane_m}};
  const Character character(def);
  CharacterState state = initialState(character, character.source(-1));
  const double sag_m = 1000 * kGravity * plane_m * plane_m / (4 * soft.rigidity_Pa);
  const Vec3 rigid(0, 1, 0.15);
  EXPECT_NEAR(rigid.y() - middle(state).y(), sag_m, 0.01 * sag_m);
  const Vec3 before = middle(state);
  run(character, -1, 30, state);
  EXPECT_LT((middle(state) - before).norm(), 1e-5 * sag_m);
  EXPECT_LT(speed(state), 1e-5);
}

TEST(SoftFlesh, HeldPointsStayWithTheirJoint) {
  for (const BodyBasisDef& basis : {BodyBasisDef{}, quadratic()}) {
    CharacterDef def = jelly(basis);
    def.motions = {{"shake",
                    0.5,
                    true,
                    {test::track("hip", "ty", {{0, 0}, {0.25, 0.1}, {0.5, 0}}),
                     test::track("hip", "ry", {{0, 0}, {0.2, 1}, {0.5, 0}})}}};
    const Character character(def);
    CharacterState state = initialState(character, character.source(0));
    const auto& part = character.softFlesh()->parts()[0];
    EXPECT_EQ(part.held_m.size(), basis.kind == BodyBasisDef::Kind::affine ? 3u : 6u);
    for (int f = 0; f < 30; ++f) {
      run(character, 0, 1, state);
      for (const Vec3& held_m : part.held_m) {
        const Vec3 joint = (state.skeleton.joint_world[0] * part.inJoint).point(held_m);
        EXPECT_LT((state.flesh.worldFromMaterial(SolidId(0), held_m) - joint).norm(), 1e-7);
      }
    }
  }
}

// Held in a plane at the distance l and shaken along it, the body of radius R shears by y = Y x:
//     (1 + R²/(5 l²)) y¨ + µ/(ρ l²) (y + τ y˙) = −x¨
// and its middle moves by x + y: with the joint when slow, behind it when fast.
TEST(SoftFlesh, LagsBehindAJointThatShakes) {
  const double l_m = 0.06, radius_m = 0.1;
  const auto follow = [&](double period_s, int periods) {
    CharacterDef def = jelly();
    def.flesh.solids[0].soft->held_m = {{0.05, -0.03, -l_m}, {-0.05, -0.03, -l_m}, {0, 0.06, -l_m}};
    def.simulation.gravity_m_per_s2.setZero();
    std::vector<Key> keys;
    for (int k = 0; k <= 16; ++k)
      keys.push_back({period_s * k / 16, 1e-3 * std::sin(2 * kPi * k / 16)});
    def.motions = {{"shake", period_s, true, {test::track("hip", "ty", keys)}}};
    const Character character(def);
    CharacterState state = initialState(character, character.source(0));
    SkinStats stats;
    constexpr int kSteps = 32;
    std::complex<double> sum = 0;  // the first Fourier term of the last period
    for (int f = 1; f <= periods * kSteps; ++f) {
      advance(character, character.source(0), period_s / kSteps, state, stats);
      if (f > (periods - 1) * kSteps)
        sum += (middle(state).y() - 1) * std::polar(1.0, -2 * kPi * f / kSteps);
    }
    const std::complex<double> i(0, 1), found = 2.0 * i * sum / (1e-3 * kSteps);
    const SoftSolidDef& soft = *def.flesh.solids[0].soft;
    const double omega = 2 * kPi / period_s;
    const double inertia = 1 + radius_m * radius_m / (5 * l_m * l_m);
    const double stiffness = 4 * soft.rigidity_Pa / (1000 * l_m * l_m);
    const std::complex<double> expected =
        1.0 + omega * omega /
                  (stiffness * (1.0 + i * omega * soft.relaxation_s) - inertia * omega * omega);
    EXPECT_LT(std::abs(found - expected), 0.03) << found << expected;
    return -std::arg(found);
  };
  EXPECT_NEAR(follow(1, 3), 0, 0.05);
  EXPECT_GT(follow(0.08, 25), 0.6);
}

CharacterDef skinnedJelly(const BodyBasisDef& basis) {
  CharacterDef def = test::smallCharacter();
  SoftSolidDef& soft = def.flesh.solids[0].soft.emplace();
  soft.basis = basis;
  soft.rigidity_Pa = 3e3, soft.volume_Pa = 3e4;
  def.skin->grid.columns = 16, def.skin->grid.rows = 24;
  return def;
}

TEST(SoftFlesh, SkinStaysOutOfItAndFollowsIt) {
  const Vec3 below(0, -0.2, 0);
  for (const BodyBasisDef& basis : {BodyBasisDef{}, quadratic()}) {
    const Character character(skinnedJelly(basis));
    CharacterState state = initialState(character, character.source(0));
    SkinStats stats;
    double farthest_m = 0;
    for (int f = 0; f < 60; ++f) {
      advance(character, character.source(0), kFrame_s, state, stats);
      measureSkin(*character.skin(), {&state.flesh, state.skeleton.joint_world}, state.skin, stats);
      farthest_m = std::max(farthest_m, (state.flesh.worldFromMaterial(SolidId(0), below) -
                                         state.flesh.rigid().frame(SolidId(0)).point(below))
                                            .norm());
    }
    EXPECT_LT(stats.max_penetration_m, 1e-4);
    EXPECT_GT(farthest_m, 0.005);  // it does move
    EXPECT_EQ(stats.repaired_points, 0u);
  }
}

TEST(SoftFlesh, HasTheSameBitsOnAnyNumberOfThreads) {
  const auto hash = [](int threads) {
    const ThreadLimit limit(threads);
    const Character character(skinnedJelly(quadratic()));
    CharacterState state = initialState(character, character.source(0));
    run(character, 0, 20, state);
    return hashOf(character, state);
  };
  EXPECT_EQ(hash(1), hash(4));
}

TEST(SoftFlesh, CopiedStatesGoOnAlike) {
  const Character character(skinnedJelly(quadratic()));
  CharacterState state = initialState(character, character.source(0));
  run(character, 0, 10, state);
  CharacterState copy = state;
  run(character, 0, 10, state);
  run(character, 0, 10, copy);
  EXPECT_EQ(hashOf(character, state), hashOf(character, copy));
  copy.bodies.r[0] += 1e-9;
  EXPECT_NE(hashOf(character, state), hashOf(character, copy));
}

TEST(SoftFlesh, ComesAlongWhenItsJointJumps) {
  CharacterDef def = jelly(quadratic());
  std::vector<Key> keys;
  for (const auto& [time_s, x_m] :
       {std::pair{0.0, 0.0}, {0.0999, 0.0}, {0.1, 50.0}, {0.3, 50.0}, {0.3001, 0.0}, {1.0, 0.0}})
    keys.push_back({time_s, x_m, 1, 0, 0});
  def.motions = {{"jump", 1, false, {test::track("hip", "tx", keys)}}};
  const Character character(def);
  CharacterState state = initialState(character, character.source(0));
  SkinStats stats;
  for (int f = 0; f < 50; ++f) {
    advance(character, character.source(0), kFrame_s, state, stats);
    const Vec3 rigid = state.flesh.rigid().frame(SolidId(0)).translation_m;
    EXPECT_LT((middle(state) - rigid).norm(), 0.2) << f;
  }
  EXPECT_GT(stats.repaired_points, 0u);
}

TEST(SoftFlesh, RecordingShowsItAgain) {
  CharacterDef def = jelly(quadratic());
  def.motions = {{"shake", 0.5, true, {test::track("hip", "ty", {{0, 0}, {0.25, 0.1}, {0.5, 0}})}}};
  const Character character(def);
  RecordOptions options;
  options.duration_s = 0.3;
  const Recording recording = record(character, character.source(0), options);
  CharacterState lived = initialState(character, character.source(0)), shown;
  run(character, 0, 10, lived);
  const Recording::Frame& frame = recording.frames[10];
  ASSERT_EQ(frame.soft_shapes.size(), character.softFlesh()->shapeSize());
  shown.time_s = frame.time_s;
  character.softFlesh()->setShapes(frame.soft_shapes, frame.time_s, shown.bodies);
  poseLayers(character, character.source(0), false, shown);
  for (const Vec3& X : {Vec3(0, 0, 0), Vec3(0.05, 0.03, 0.08)})
    EXPECT_LT((shown.flesh.worldFromMaterial(SolidId(0), X) -
               lived.flesh.worldFromMaterial(SolidId(0), X))
                  .norm(),
              1e-9);
  // Any other time shows it where its joint is, at rest.
  shown.time_s = 0.25;
  poseLayers(character, character.source(0), false, shown);
  EXPECT_LT((middle(shown) - shown.flesh.rigid().frame(SolidId(0)).translation_m).norm(), 1e-9);
}

TEST(SoftFlesh, NamesEveryFault) {
  CharacterDef def = jelly();
  SoftSolidDef& soft = *def.flesh.solids[0].soft;
  soft.density_kg_per_m3 = 0;
  soft.rigidity_Pa = -1;
  soft.relaxation_s = std::nan("");
  soft.basis = {.kind = BodyBasisDef::Kind::polynomial, .order = 9};
  soft.held_m = {{0, 0, 0}, {0, 0.2, 0}};
  def.ornaments.solids = {test::ball("eye", "hip", 0, 0.01)};
  def.ornaments.solids[0].soft.emplace();
  EXPECT_THAT(faults(def), testing::UnorderedElementsAre(
                               "/solids/0/soft/density_kg_per_m3", "/solids/0/soft/rigidity_Pa",
                               "/solids/0/soft/relaxation_s", "/solids/0/soft/basis/polynomial",
                               "/solids/0/soft/held_m/1/1", "/ornaments/0/soft"));
}

TEST(SoftFlesh, HasNoDriversAndNoKeys) {
  CharacterDef def = jelly();
  def.flesh.solids[0].drivers = {{"radius_m", "hip", Dof::ry, {{0, 0.1}, {1, 0.12}}}};
  EXPECT_THAT(faults(def), testing::ElementsAre("/solids/0/drivers"));
  def = jelly();
  TrackDef keys{TrackDef::Target::solid, "belly", "radius_m", {{0, 0.1}, {1, 0.12}}};
  def.motions = {{"swell", 1, false, {keys}}};
  EXPECT_THAT(faults(def), testing::ElementsAre("/motions/0/tracks/0"));
}

}  // namespace
}  // namespace fascia
