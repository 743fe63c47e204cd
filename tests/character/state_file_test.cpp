#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <fascia/base/hash.h>
#include <fascia/character/recording.h>
#include <fascia/io/state/state_file.h>

#include "small_character.h"

namespace fascia {
namespace {

using testing::HasSubstr;

constexpr double kStateFrame_s = 1.0 / 60;
constexpr std::size_t kStateHead = 8 + 4 + 8 + 8;  // magic, version, length, hash

// Soft, in contact with itself, held: a state with everything in it.
CharacterDef richCharacter() {
  CharacterDef def = test::smallCharacter();
  def.flesh.solids.front().soft.emplace();
  def.skin->contact.self = true;
  return def;
}

CharacterState runFor(const Character& character, int frames) {
  const PostureSource& source = character.source(0);
  CharacterState state = initialState(character, source);
  const int head = 2;
  state.held = {{SolidId{head}, 0, 0.16, 0.0}};
  SkinStats stats;
  for (int f = 0; f < frames; ++f) advance(character, source, kStateFrame_s, state, stats);
  return state;
}

template <class T>
void patch(std::string& bytes, std::size_t at, T value) {
  ASSERT_LE(at + sizeof value, bytes.size());
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

// The bytes with the length and hash that they should have: as somebody with bad intentions would.
std::string sealed(std::string bytes) {
  StateHash hash;
  hash.add(bytes.data() + kStateHead, bytes.size() - kStateHead);
  patch(bytes, 12, static_cast<std::uint64_t>(bytes.size() - kStateHead));
  patch(bytes, 20, hash.value());
  return bytes;
}

void expectRefused(const Character& character, const std::string& bytes,
                   const std::string& message) {
  try {
    loadState(character, bytes, "a.fstate");
    ADD_FAILURE() << "was read, expected: " << message;
  } catch (const Error& error) {
    EXPECT_EQ(error.issues().front().where.file, "a.fstate");
    EXPECT_THAT(error.what(), HasSubstr(message));
  }
}

TEST(StateFile, ComesBackAsItWas) {
  const Character character(richCharacter());
  const CharacterState state = runFor(character, 9);
  const std::string bytes = saveState(character, state);
  const CharacterState back = loadState(character, bytes);
  EXPECT_EQ(back.time_s, state.time_s);
  EXPECT_EQ(back.posture.values, state.posture.values);
  EXPECT_EQ(back.posture.rates, state.posture.rates);
  EXPECT_EQ(back.bodies.r, state.bodies.r);
  EXPECT_EQ(back.held.size(), 1u);
  EXPECT_EQ(back.skin.surroundings.fleshNormal.x, state.skin.surroundings.fleshNormal.x);
  EXPECT_FALSE(back.skin.surroundings.fleshNormal.x.empty());
  EXPECT_EQ(saveState(character, back), bytes);
}

TEST(StateFile, GoesOnWithRotationsOfJoints) {
  CharacterDef def = richCharacter();
  def.skeleton.joints[1].dofs = {{Dof::rx}, {Dof::ry}, {Dof::rz}};
  const Character character(def);
  class Turning final : public PostureSource {
   public:
    explicit Turning(const Skeleton& skeleton) : rest_(skeleton.restPosture()) {}
    void sample(double time_s, PostureSample& out) const override {
      out.posture = rest_;
      out.posture.rotations = {
          {JointId{1}, Quat(Eigen::AngleAxisd(3 * time_s, Vec3::UnitY())), Vec3(0, 3, 0)}};
      out.parameters = {{SolidId{1}, 0, 0.2 + 0.05 * std::sin(9 * time_s), 0.45, 0.5}};
    }

   private:
    Posture rest_;
  };
  const Turning source(character.skeleton());
  CharacterState state = initialState(character, source);
  SkinStats stats;
  for (int f = 0; f < 20; ++f) advance(character, source, kStateFrame_s, state, stats);
  ASSERT_EQ(state.posture.rotations.size(), 1u);
  CharacterState back = loadState(character, saveState(character, state));
  EXPECT_EQ(back.flesh.bounds(SolidId{1}).high, state.flesh.bounds(SolidId{1}).high);
  for (int f = 0; f < 20; ++f) {
    advance(character, source, kStateFrame_s, state, stats);
    advance(character, source, kStateFrame_s, back, stats);
    ASSERT_EQ(hashOf(character, back), hashOf(character, state)) << f;
  }
}

Recording recordFor(const Character& character, double duration_s, const CharacterState* from,
                    CharacterState* last = nullptr) {
  RecordOptions options;
  options.duration_s = duration_s;
  options.from = from;
  options.last = last;
  return record(character, character.source(0), options);
}

TEST(StateFile, RecordingsGoOnFromIt) {
  const Character character(richCharacter());
  const Recording whole = recordFor(character, 0.4, nullptr);
  CharacterState middle;
  recordFor(character, 0.2, nullptr, &middle);
  const CharacterState back = loadState(character, saveState(character, middle));
  const Recording rest = recordFor(character, 0.2, &back);
  ASSERT_EQ(rest.frames.size(), 13u);
  EXPECT_EQ(rest.frames.front().time_s, middle.time_s);
  for (std::size_t f = 0; f < rest.frames.size(); ++f)
    EXPECT_EQ(rest.frames[f].skin_m, whole.frames[12 + f].skin_m) << f;
  EXPECT_EQ(rest.state_hash, whole.state_hash);
  // Without a duration: what is left of 2 s.
  EXPECT_EQ(recordFor(character, 0, &back).frames.size(), 109u);
}

TEST(StateFile, IsRefusedByAnotherCharacter) {
  const Character character(richCharacter());
  const std::string bytes = saveState(character, runFor(character, 2));
  CharacterDef def = richCharacter();
  def.skin->grid.columns = 16;
  expectRefused(Character(def), bytes, "it has 12 skin points around, this one 16");
  def = richCharacter();
  def.flesh.solids.push_back(test::ball("hat", "neck", 0.3, 0.1));
  expectRefused(Character(def), bytes, "it has 3 solids, this one 4");
  def = richCharacter();
  def.flesh.solids.front().soft.reset();
  expectRefused(Character(def), bytes, "coordinates of soft solids, this one 0");
  def = richCharacter();
  def.skin.reset();
  expectRefused(Character(def), bytes, "its skin is a grid, this one's none");
  def = richCharacter();
  def.flesh.solids[1].name = "ribs";
  expectRefused(Character(def), bytes, "its joints, solids or morphs have other names");
}

TEST(StateFile, GoesOnInACharacterOfAnotherMaterial) {
  const Character character(richCharacter());
  CharacterDef def = richCharacter();
  def.skin->tissue.stiffness_N_per_m3 *= 2;
  const Character stiffer(def);
  CharacterState state = loadState(stiffer, saveState(character, runFor(character, 2)));
  SkinStats stats;
  advance(stiffer, stiffer.source(0), kStateFrame_s, state, stats);
  EXPECT_EQ(stats.repaired_points, 0u);
}

TEST(StateFile, StatesOfOthersAreNotSaved) {
  const Character character(richCharacter());
  CharacterState state = runFor(character, 1);
  state.skin.velocity.resize(3);
  EXPECT_THROW(saveState(character, state), Error);
}

TEST(StateFile, RefusesEveryTruncationAndFlippedBit) {
  const Character character(richCharacter());
  const std::string bytes = saveState(character, runFor(character, 2));
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 40)
    EXPECT_THROW(loadState(character, bytes.substr(0, size)), Error) << size;
  expectRefused(character, bytes.substr(0, bytes.size() - 1), "is cut short");
  expectRefused(character, bytes + "x", "has bytes after its end");
  std::mt19937 random(5);
  for (int i = 0; i < 2000; ++i) {
    std::string flipped = bytes;
    // Half of them in what comes before the numbers.
    const std::size_t at = random() % (i % 2 == 0 ? bytes.size() : kStateHead + 80);
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << (random() % 8)));
    EXPECT_THROW(loadState(character, flipped), Error) << at;
  }
}

TEST(StateFile, RefusesNumbersThatAreNone) {
  const Character character(richCharacter());
  const std::string bytes = saveState(character, runFor(character, 2));
  const std::size_t time = kStateHead + 10 * 8;
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    std::string wrong = bytes;
    patch(wrong, time, bad);
    EXPECT_THROW(loadState(character, sealed(wrong)), Error) << bad;
  }
  std::string longer = bytes;
  patch(longer, time + 8, std::uint64_t{1} << 60);
  expectRefused(character, sealed(longer), "is cut short");
}

// Whatever is read can be gone on with.
TEST(StateFile, HostileFilesAreRefusedOrGoOn) {
  const Character character(richCharacter());
  const ClipSource source = character.source(0);
  const std::string bytes = saveState(character, runFor(character, 3));
  std::mt19937 random(7);
  int goOn = 0;
  for (int i = 0; i < 1500; ++i) {
    std::string mutant = bytes;
    for (std::size_t n = 1 + random() % 3; n > 0; --n) {
      const std::size_t at = kStateHead + random() % (mutant.size() - kStateHead);
      if (random() % 8 == 0)
        mutant.erase(at, random() % 16);
      else if (random() % 8 == 0)
        mutant.insert(at, mutant.substr(at, random() % 16));
      else
        mutant[at] = static_cast<char>(random());
    }
    try {
      CharacterState state = loadState(character, sealed(mutant));
      SkinStats stats;
      advance(character, source, kStateFrame_s, state, stats);
      ++goOn;
      for (const float x : state.skin.position.x) ASSERT_TRUE(std::isfinite(x)) << i;
    } catch (const Error& error) {
      EXPECT_FALSE(error.issues().empty());
    }
  }
  EXPECT_GT(goOn, 100);
  EXPECT_LT(goOn, 1450);
}

}  // namespace
}  // namespace fascia
