#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fascia/base/parallel.h>
#include <fascia/character/recording.h>

#include "small_character.h"

namespace fascia {
namespace {

using test::faults;
using test::hashAfter;

CharacterState run(const Character& character, int frames, CharacterState state) {
  SkinStats stats;
  for (int f = 0; f < frames; ++f) advance(character, character.source(0), 1.0 / 60, state, stats);
  return state;
}

TEST(Determinism, SameBitsOnAnyNumberOfThreads) {
  for (const int rows : {16, 24, 128}) {  // the last rides on a coarse grid, in tiles
    const Character character(test::fineCharacter(rows));
    EXPECT_EQ(character.skin()->coarse() != nullptr, rows == 128);
    std::uint64_t hash[3];
    for (int n = 0; n < 3; ++n) {
      const ThreadLimit limit(1 << n);
      hash[n] = hashAfter(character, 12);
    }
    EXPECT_EQ(hash[0], hash[1]) << rows;
    EXPECT_EQ(hash[0], hash[2]) << rows;
    EXPECT_NE(hash[0], hashAfter(character, 13));
  }
}

TEST(Determinism, TheBuiltSkinHasTheSameBitsOnAnyNumberOfThreads) {
  std::uint64_t hash[2];
  for (int n = 0; n < 2; ++n) {
    const ThreadLimit limit(n == 0 ? 1 : 4);
    const Character character(test::smallCharacter());
    hash[n] = hashAfter(character, 1);
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TEST(CharacterState, RewoundToACopyGivesTheSameBits) {
  for (const int side : {16, 80}) {
    const Character character(test::fineCharacter(side));
    CharacterState state = run(character, 5, initialState(character, character.source(0)));
    const CharacterState saved = state;
    const std::uint64_t before = hashOf(character, state);
    state = run(character, 7, std::move(state));
    const std::uint64_t first = hashOf(character, state);
    EXPECT_EQ(hashOf(character, saved), before);  // a copy of its own
    EXPECT_NE(first, before);
    EXPECT_EQ(hashOf(character, run(character, 7, saved)), first);
    // Back into the memory of the run that went on.
    state = saved;
    EXPECT_EQ(hashOf(character, run(character, 7, std::move(state))), first);
  }
}

TEST(CharacterState, HashCoversEveryPointsPositionAndVelocity) {
  const Character character(test::smallCharacter());
  CharacterState state = initialState(character, character.source(0));
  const std::uint64_t hash = hashOf(character, state);
  const std::size_t k = character.skin()->grid()->layout().at(11, 15);
  for (FloatArray* value : {&state.skin.position.x, &state.skin.velocity.z}) {
    const float was = (*value)[k];
    (*value)[k] = std::nextafter(was, 10.f);
    EXPECT_NE(hashOf(character, state), hash);
    (*value)[k] = was;
  }
  EXPECT_EQ(hashOf(character, state), hash);
}

TEST(Character, SettlesBeforeItStarts) {
  CharacterDef def = test::smallCharacter();
  def.simulation.settle_s = 2;
  const Character character(def);
  const CharacterState state = initialState(character, character.source(-1));
  EXPECT_EQ(state.time_s, 0);
  EXPECT_LT(state.skin.maxSpeed_m_per_s, 0.02f);
}

// The hip goes at a constant speed, from the first moment on.
class Gliding final : public PostureSource {
 public:
  Gliding(const Skeleton& skeleton, double speed_m_per_s)
      : rest_(skeleton.restPosture()), speed_m_per_s_(speed_m_per_s) {}
  void sample(double time_s, PostureSample& out) const override {
    out.posture = rest_;
    out.posture.values[0] = speed_m_per_s_ * time_s, out.posture.rates[0] = speed_m_per_s_;
    out.parameters.clear();
  }

 private:
  Posture rest_;
  double speed_m_per_s_;
};

// How far the skin is behind a skin that stands, beside a hip that has gone 1 m/s for a frame.
double lag_m(const CharacterDef& def) {
  const Character character(def);
  constexpr double kFrame_s = 1.0 / 60;
  SkinStats stats;
  CharacterState state[2];
  for (int moving = 0; moving < 2; ++moving) {
    const Gliding source(character.skeleton(), moving);
    state[moving] = initialState(character, source);
    advance(character, source, kFrame_s, state[moving], stats);
  }
  const double way_m = state[1].skeleton.joint_world[0].translation_m.x() -
                       state[0].skeleton.joint_world[0].translation_m.x();
  EXPECT_NEAR(way_m, kFrame_s, 1e-3);
  const GridLayout& g = character.skin()->grid()->layout();
  double sum = 0;
  for (int j = 0; j < g.rows; ++j)
    for (int i = 0; i < g.columns; ++i)
      sum += state[0].skin.position.x[g.at(i, j)] + way_m - state[1].skin.position.x[g.at(i, j)];
  return sum / (g.rows * g.columns);
}

// A motion that starts moving takes its skin along, whatever steps it.
TEST(Character, HasASkinThatStartsWithTheVelocityOfWhatCarriesIt) {
  for (const char* integrator : {"auto", "leapfrog", "rk4", "verlet"}) {
    for (const double settle_s : {0.0, 0.1}) {
      CharacterDef def = test::smallCharacter();
      def.simulation.integrator = integrator;
      def.simulation.settle_s = settle_s;
      EXPECT_LT(std::abs(lag_m(def)), 5e-4) << integrator << " " << settle_s;
    }
  }
  EXPECT_LT(std::abs(lag_m(test::fineCharacter(128))), 5e-4);  // rides on a coarse grid
}

TEST(Character, OfFrozenPostureComesToTheSameRestWithAnyFrameRate) {
  CharacterDef def = test::smallCharacter();
  def.simulation.settle_s = 0;
  const Character character(def);
  CharacterState state[2];
  SkinStats stats;
  for (int n = 0; n < 2; ++n) {
    const double frame = n == 0 ? 1.0 / 120 : 1.0 / 15;
    state[n] = initialState(character, character.source(-1));
    for (int f = 0; f < 6 / frame; ++f)
      advance(character, character.source(-1), frame, state[n], stats);
  }
  const GridLayout& g = character.skin()->grid()->layout();
  double farthest = 0;
  for (int j = 0; j < g.rows; ++j)
    for (int i = 0; i < g.columns; ++i)
      farthest = std::max<double>(farthest, std::abs(state[0].skin.position.y[g.at(i, j)] -
                                                     state[1].skin.position.y[g.at(i, j)]));
  EXPECT_LT(farthest, 2e-3);
}

TEST(Character, DividesLongFrames) {
  const Character character(test::smallCharacter());
  CharacterState whole = initialState(character, character.source(0)),
                 parts = initialState(character, character.source(0));
  SkinStats stats;
  advance(character, character.source(0), 0.25, whole, stats);
  for (int i = 0; i < 3; ++i) advance(character, character.source(0), 0.25 / 3, parts, stats);
  EXPECT_NEAR(whole.time_s, parts.time_s, 1e-12);
  const std::size_t k = character.skin()->grid()->layout().at(3, 8);
  EXPECT_NEAR(whole.skin.position.x[k], parts.skin.position.x[k], 1e-4);
  EXPECT_LE(stats.step_max_s, 1.0 / 12);
}

// At any moment, up and down, and on (Turner & Gobbetti 1998, §6.5).
TEST(Resolution, CanChangeAtAnyMomentOfARun) {
  CharacterDef def = test::smallCharacter();
  const Character coarse(def);
  def.skin->grid.columns = 30, def.skin->grid.rows = 41;
  const Character fine(def);
  CharacterState state = run(coarse, 9, initialState(coarse, coarse.source(0)));
  const Character* from = &coarse;
  SkinStats stats;
  for (const Character* to : {&fine, &coarse, &fine}) {
    CharacterState next;
    next.time_s = state.time_s;
    next.skin = resampled(*from->skin(), state.skin, *to->skin());
    const float middle =
        state.skin.position
            .x[from->skin()->grid()->layout().at(0, from->skin()->grid()->rows() / 2)];
    EXPECT_NEAR(
        next.skin.position.x[to->skin()->grid()->layout().at(0, to->skin()->grid()->rows() / 2)],
        middle, 0.05);
    for (int f = 0; f < 10; ++f) {
      advance(*to, to->source(0), 1.0 / 60, next, stats);
      EXPECT_TRUE(test::allFinite(*to, next));
      measureSkin(*to->skin(), {&next.flesh, next.skeleton.joint_world}, next.skin, stats);
    }
    state = std::move(next);
    from = to;
  }
  EXPECT_LE(stats.max_penetration_m, 1e-4);
  EXPECT_EQ(stats.repaired_points, 0u);
  EXPECT_LT(stats.max_edge_stretch, 4);
}

TEST(CharacterFaults, OfTheSimulationAreNamedByTheirPointerAllAtOnce) {
  EXPECT_THAT(faults(test::smallCharacter()), testing::IsEmpty());
  CharacterDef def = test::smallCharacter();
  def.simulation.frame_rate_hz = 0;
  def.simulation.integrator = "magic";
  def.simulation.gravity_m_per_s2 = Vec3(0, NAN, 0);
  def.simulation.settle_s = 1e9;
  def.simulation.max_step_s = 1;
  EXPECT_THAT(faults(def),
              testing::UnorderedElementsAre("/simulation/frame_rate_hz", "/simulation/integrator",
                                            "/simulation/gravity_m_per_s2/1",
                                            "/simulation/settle_s", "/simulation/max_step_s"));
}

TEST(CharacterFaults, OfItsLayersAreNamedByTheirPointerAllAtOnce) {
  CharacterDef def = test::smallCharacter();
  def.motions.push_back(def.motions[0]);
  def.motions[1].tracks[0].name = "knee";
  def.flesh.solids[1].joint = "elbow";
  EXPECT_THAT(faults(def), testing::UnorderedElementsAre(
                               "/motions/1/name", "/motions/1/tracks/0/joint", "/solids/1/joint"));
}

TEST(CharacterFaults, OfOverridesAreFoundToo) {
  BuildOptions narrow, magic, slow;
  narrow.columns = 3, magic.integrator = "magic", slow.step_s = 7;
  EXPECT_THAT(faults(test::smallCharacter(), narrow), testing::ElementsAre("/skin/grid/0"));
  EXPECT_THAT(faults(test::smallCharacter(), magic),
              testing::ElementsAre("/simulation/integrator"));
  EXPECT_THAT(faults(test::smallCharacter(), slow), testing::ElementsAre("/simulation/step_s"));
}

TEST(Recording, HoldsAFrameForEveryMomentFromStartToEnd) {
  const Character character(test::smallCharacter());
  RecordOptions options;
  options.frame_rate_hz = 30, options.duration_s = 0.5;
  std::vector<double> progress;
  options.progress = [&](double done) {
    progress.push_back(done);
    return true;
  };
  const Recording recording = record(character, character.source(0), options);
  ASSERT_EQ(recording.frames.size(), 16u);
  EXPECT_NEAR(recording.frames[15].time_s, 0.5, 1e-9);
  EXPECT_EQ(recording.frames[3].skin_m.size(), recording.skin.positions.size());
  EXPECT_EQ(recording.skin.positions.size(), 13u * 16 + 2);
  EXPECT_TRUE(std::is_sorted(progress.begin(), progress.end()));
  EXPECT_EQ(progress.back(), 1);
  CharacterState state = initialState(character, character.source(0));
  SkinStats stats;
  for (int f = 0; f < 15; ++f) advance(character, character.source(0), 1.0 / 30, state, stats);
  EXPECT_EQ(recording.state_hash, hashOf(character, state));  // what a player sees is what is baked
}

TEST(Recording, StopsWhenAsked) {
  const Character character(test::smallCharacter());
  RecordOptions options;
  options.duration_s = 1;
  options.progress = [](double done) { return done < 0.1; };
  EXPECT_THROW(record(character, character.source(-1), options), Error);
}

}  // namespace
}  // namespace fascia
