#include <gtest/gtest.h>

#include <fascia/base/parallel.h>
#include <fascia/base/random.h>

#include <fascia/io/state/state_file.h>

#include "examples.h"
#include "fleshed_rig.h"
#include "support/assets.h"

// A state is the whole state: copies, which have none of the original's scratch memory, go on bit
// for bit like the original, from any moment of any motion. So do saved ones that are read for a
// character which was built anew.

namespace fascia {
namespace {

constexpr double kCopiedFrame_s = 1.0 / 60;
constexpr int kCopiedFrames = 12;

// What is seen of a state beyond its skin, which the hash is of.
void expectSameLayers(const CharacterState& a, const CharacterState& b, const std::string& what) {
  ASSERT_EQ(a.skeleton.joint_world.size(), b.skeleton.joint_world.size()) << what;
  EXPECT_TRUE(a.skeleton.joint_world == b.skeleton.joint_world) << what;
  ASSERT_EQ(a.flesh.solidCount(), b.flesh.solidCount()) << what;
  ASSERT_EQ(a.ornaments.solidCount(), b.ornaments.solidCount()) << what;
  for (std::size_t i = 0; i < a.flesh.solidCount(); ++i) {
    const SolidId id{static_cast<std::int64_t>(i)};
    // Soft ones were seen between two of their steps, by a rounding error before the last.
    const double most_m = a.flesh.softOf(id).valid() ? 1e-9 : 0;
    const Box at = a.flesh.bounds(id), there = b.flesh.bounds(id);
    EXPECT_LE((at.low - there.low).norm(), most_m) << what;
    EXPECT_LE((at.high - there.high).norm(), most_m) << what;
  }
}

void advanceWith(int threads, const Character& character, const PostureSource& source,
                 CharacterState& state) {
  const ThreadLimit limit(threads);
  SkinStats stats;
  advance(character, source, kCopiedFrame_s, state, stats);
}

void expectCopiesToGoOn(const Character& character, Random& random, const std::string& what) {
  const auto motion = static_cast<std::size_t>(
      random.uniform(0, 1) * static_cast<double>(character.motionCount()) * 0.999);
  const PostureSource& source = character.source(static_cast<int>(motion));
  CharacterState state = initialState(character, source);
  const int before = 3 + static_cast<int>(random.uniform(0, 25));
  for (int f = 0; f < before; ++f) advanceWith(0, character, source, state);

  const Character again(character.def());
  const PostureSource& sourceAgain = again.source(static_cast<int>(motion));
  CharacterState copy = state, saved = loadState(again, saveState(character, state));
  ASSERT_EQ(hashOf(character, copy), hashOf(character, state)) << what;
  ASSERT_EQ(hashOf(again, saved), hashOf(character, state)) << what;
  expectSameLayers(saved, state, what);
  for (int f = 0; f < kCopiedFrames; ++f) {
    advanceWith(1 + f % 3, character, source, copy);
    advanceWith(1 + (f + 1) % 3, again, sourceAgain, saved);
    advanceWith(0, character, source, state);
    const std::string when = what + ", motion " + std::to_string(motion) + ", " +
                             std::to_string(f + 1) + " frames after the " + std::to_string(before) +
                             "th";
    ASSERT_EQ(hashOf(character, copy), hashOf(character, state)) << when;
    ASSERT_EQ(hashOf(again, saved), hashOf(character, state)) << when;
  }
  expectSameLayers(saved, state, what);
}

class StateCopies : public testing::TestWithParam<std::string> {};

TEST_P(StateCopies, GoOnLikeTheOriginal) {
  Random random(11);
  for (const char* integrator : {"auto", "leapfrog", "cloth", "verlet", "rosenbrock4"}) {
    if (integrator == std::string_view("cloth") && readCharacterFile(GetParam()).def.skin->surface)
      continue;  // of grids
    const bool implicit = std::string_view(integrator) == "rosenbrock4";
    const int side = implicit ? 8 : 24;
    expectCopiesToGoOn(test::loadExample(GetParam(), side, side, integrator), random, integrator);
  }
}

TEST_P(StateCopies, GoOnLikeTheOriginalInContactWithThemselves) {
  Random random(12);
  CharacterDef def = readCharacterFile(GetParam()).def;
  if (!def.skin) GTEST_SKIP() << "no skin";
  def.skin->contact.self = true;
  for (int n = 0; n < 2; ++n) expectCopiesToGoOn(Character(def), random, "self-contact");
}

TEST_P(StateCopies, GoOnLikeTheOriginalUnderFatThatKeepsItsVolume) {
  Random random(14);
  CharacterDef def = readCharacterFile(GetParam()).def;
  if (!def.skin || !def.skin->surface) GTEST_SKIP() << "no surface of solids";
  def.skin->fat.bulk_Pa = 4e4;
  const Character character(def);
  ASSERT_NE(character.skin()->fatPressure(), nullptr);
  for (int n = 0; n < 2; ++n) expectCopiesToGoOn(character, random, "firm fat");
}

TEST(StateCopies, OfRigsGoOnLikeTheOriginal) {
  const auto file = assetFile("mesh2motion-cc0/fox-animations.glb");
  if (!file) GTEST_SKIP() << "the shared assets are not here";
  Random random(13);
  for (const bool simulate : {false, true}) {
    for (const bool soft : {false, true}) {
      CharacterDef def = test::fleshOut(file->string());
      def.skin->mesh.pose.simulate = simulate;
      if (soft) def.flesh.solids.front().soft.emplace();
      def.skin->fat.bulk_Pa = simulate ? 4e4 : 0;
      expectCopiesToGoOn(Character(def), random, soft ? "soft fox" : "fox");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Files, StateCopies, testing::ValuesIn(test::exampleCharacters()),
                         test::exampleName);

}  // namespace
}  // namespace fascia
