#include <gtest/gtest.h>

#include <fascia/base/parallel.h>
#include <fascia/base/random.h>

#include "examples.h"
#include "support/assets.h"

// A state is the whole state: copies, which have none of the original's scratch memory, go on bit
// for bit like the original, from any moment of any motion.

namespace fascia {
namespace {

constexpr double kFrame_s = 1.0 / 60;
constexpr int kFrames = 12;

void expectCopiesToGoOn(const Character& character, Random& random, const std::string& what) {
  const auto motion = static_cast<std::size_t>(random.uniform(0, 1) *
                                               static_cast<double>(character.motionCount()) * 0.999);
  const PostureSource& source = character.source(static_cast<int>(motion));
  CharacterState state = initialState(character, source);
  SkinStats stats;
  const int before = 3 + static_cast<int>(random.uniform(0, 25));
  for (int f = 0; f < before; ++f) advance(character, source, kFrame_s, state, stats);
  CharacterState copy = state;
  ASSERT_EQ(hashOf(character, copy), hashOf(character, state)) << what;
  for (int f = 0; f < kFrames; ++f) {
    {
      const ThreadLimit limit(1 + f % 3);
      advance(character, source, kFrame_s, copy, stats);
    }
    advance(character, source, kFrame_s, state, stats);
    ASSERT_EQ(hashOf(character, copy), hashOf(character, state))
        << what << ", motion " << motion << ", " << f + 1 << " frames after the " << before << "th";
  }
}

class StateCopies : public testing::TestWithParam<std::string> {};

TEST_P(StateCopies, GoOnLikeTheOriginal) {
  Random random(11);
  for (const char* integrator : {"auto", "leapfrog", "verlet", "rosenbrock4"}) {
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

TEST(StateCopies, OfRigsGoOnLikeTheOriginal) {
  const auto file = assetFile("mesh2motion-cc0/fox-animations.glb");
  if (!file) GTEST_SKIP() << "the shared assets are not here";
  Random random(13);
  for (const bool simulate : {false, true}) {
    for (const bool soft : {false, true}) {
      CharacterDef def = fleshOut(readRig(*file), {}).def;
      def.skin->pose.simulate = simulate;
      if (soft) def.flesh.solids.front().soft.emplace();
      expectCopiesToGoOn(Character(def), random, soft ? "soft fox" : "fox");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Files, StateCopies, testing::ValuesIn(test::exampleCharacters()),
                         test::exampleName);

}  // namespace
}  // namespace fascia
