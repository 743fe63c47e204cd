// Seeded random edits of every example while it moves. FASCIA_EDITS=10000 makes so many of each.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include <fascia/math/points.h>
#include <fascia/skin/grid/grid_wrap.h>

#include "examples.h"
#include "random_edits.h"
#include "small_character.h"

namespace fascia {
namespace {

int editCount() {
  const char* wanted = std::getenv("FASCIA_EDITS");
  return wanted ? std::atoi(wanted) : 120;
}

// Everything that stepping reads of the two.
void expectSameModels(const Skin& a, const Skin& b) {
  EXPECT_TRUE(test::sameBits(a.restPosition(), b.restPosition()));
  const PointModel &p = a.points(), &q = b.points();
  EXPECT_EQ(p.mass, q.mass);
  EXPECT_EQ(p.drag, q.drag);
  EXPECT_EQ(p.fat, q.fat);
  EXPECT_EQ(p.tissueStiffness, q.tissueStiffness);
  EXPECT_EQ(p.tissueDamping, q.tissueDamping);
  EXPECT_EQ(p.tissueRestLength, q.tissueRestLength);
  EXPECT_EQ(p.stiffnessBound, q.stiffnessBound);
  EXPECT_EQ(p.free, q.free);
  EXPECT_EQ(a.grid()->elastic().coefficients().w1, b.grid()->elastic().coefficients().w1);
  EXPECT_EQ(a.grid()->elastic().coefficients().g2, b.grid()->elastic().coefficients().g2);
  EXPECT_EQ(a.grid()->elastic().coefficients().w12, b.grid()->elastic().coefficients().w12);
  EXPECT_EQ(a.defaultStep_s(), b.defaultStep_s());
  ASSERT_EQ(a.coarse() == nullptr, b.coarse() == nullptr);
  if (a.coarse()) expectSameModels(*a.coarse(), *b.coarse());
}

// A character that is edited while it moves.
class EditedRun {
 public:
  explicit EditedRun(const Character& start)
      : character_(start), wrapped_(start), state_(initialState(start, start.source(0))) {}

  void edit(const CharacterDef& next) {
    const Character edited = character_.edited(next);
    CharacterState state = carryOver(character_, state_, edited);
    const bool sameGrid = edited.skin()->pointCount() == character_.skin()->pointCount() &&
                          edited.skin()->grid()->columns() == character_.skin()->grid()->columns();
    if (sameGrid &&
        !(wrapOf(edited) == wrapOf(character_) && fleshWentFar(state, edited.skin()->size_m()))) {
      EXPECT_TRUE(test::sameBits(state.skin.position, state_.skin.position));
      EXPECT_TRUE(test::sameBits(state.skin.velocity, state_.skin.velocity));
    }
    if (wrapOf(edited) != wrapOf(character_)) wrapped_ = Character(next);
    character_ = edited;
    state_ = std::move(state);
  }
  void frame() {
    advance(character_, character_.source(motion_), 1.0 / 60, state_, stats_);
    measureSkin(*character_.skin(), {&state_.flesh, state_.skeleton.joint_world}, state_.skin,
                stats_);
    finite_ = finite_ && test::allFinite(character_, state_);
  }

  const Character& character() const { return character_; }
  // Built afresh from the definition that the grid was last wrapped after.
  const Character& wrapped() const { return wrapped_; }
  const CharacterState& state() const { return state_; }
  const SkinStats& stats() const { return stats_; }
  bool finite() const { return finite_; }

 private:
  // A skin goes along with an edit that moves what it is tied to by more than this.
  bool fleshWentFar(const CharacterState& edited, double size_m) const {
    const VectorArray &now = edited.skin.surroundings.anchor,
                      &before = state_.skin.surroundings.anchor;
    double farthest_m = 0;
    for (std::size_t k = 0; k < now.size(); ++k)
      farthest_m = std::max(farthest_m, (pointAt(now, k) - pointAt(before, k)).norm());
    return farthest_m > 0.05 * size_m;
  }
  static const GridWrap* wrapOf(const Character& c) {
    return c.skin()->parts().gridRest->wrap.get();
  }

  Character character_, wrapped_;
  CharacterState state_;
  SkinStats stats_;
  bool finite_ = true;
  int motion_ = 0;
};

class EditedExamples : public testing::TestWithParam<std::string> {
 protected:
  // The torso's arms, neck and waist branch off its tube: fewer points slip off them.
  static bool isTorso() { return GetParam().find("torso") != std::string::npos; }
  static Character edited() {
    return isTorso() ? test::loadExample(GetParam(), 32, 32)
                     : test::loadExample(GetParam(), 16, 20);
  }
};

TEST_P(EditedExamples, StayWholeAndEndAsIfEditedAtOnce) {
  const Character start = edited();
  test::RandomEdits edits(start.def(), 7);
  EditedRun run(start);
  const int count = editCount();
  for (int n = 0; n < count; ++n) {
    CharacterDef next = run.character().def();
    const std::string what = edits.apply(next);
    SCOPED_TRACE("edit " + std::to_string(n) + ": " + what);
    run.edit(next);
    for (int f = 0; f < 1 + n % 3; ++f) run.frame();
    ASSERT_TRUE(run.finite());
    ASSERT_LE(run.stats().max_penetration_m, 1e-4);
    if (n % 16 == 15) expectSameModels(*run.character().skin(), *run.wrapped().edited(next).skin());
    if (testing::Test::HasFailure()) return;
  }
  // Hard edits one upon the other may throw a point so far that it has to be put back; rarely.
  EXPECT_LE(run.stats().repaired_points, static_cast<std::uint64_t>(count / 500));
  RecordProperty("edits", count);
}

// A moment of a source, for ever.
class Held final : public PostureSource {
 public:
  Held(const PostureSource& source, double time_s) : source_(source), time_s_(time_s) {}
  void sample(double, PostureSample& out) const override {
    source_.sample(time_s_, out);
    std::ranges::fill(out.posture.rates, 0.0);
    for (JointRotation& turn : out.posture.rotations) turn.angular_rad_per_s.setZero();
    for (Flesh::ParameterOverride& p : out.parameters) p.rate = p.weightRate_per_s = 0;
  }

 private:
  const PostureSource& source_;
  double time_s_;
};

// The largest and the root mean square distance of two states' points, over the skin's size.
std::array<double, 2> differences(const Skin& skin, const SkinState& a, const SkinState& b) {
  double largest = 0, squares = 0;
  for (std::size_t p = 0; p < skin.pointCount(); ++p) {
    const std::size_t k = skin.storageIndex(p);
    const double way = (pointAt(a.position, k) - pointAt(b.position, k)).norm();
    largest = std::max(largest, way);
    squares += way * way;
  }
  const double mean = std::sqrt(squares / static_cast<double>(skin.pointCount()));
  return {largest / skin.size_m(), mean / skin.size_m()};
}

// Edits while it moves, then a posture that is held until all is at rest, beside a character that
// was built afresh from the last definition around the same wrap and has never been edited.
TEST_P(EditedExamples, ComeToRestWhereAFreshCharacterDoes) {
  const Character start = edited();
  test::RandomEdits edits(start.def(), 23);
  EditedRun run(start);
  const GridWrap* wrap = start.skin()->parts().gridRest->wrap.get();
  for (int n = 0; n < 40; ++n) {
    CharacterDef next = run.character().def();
    edits.apply(next);
    // What wraps the grid anew forgets what was before; here edits are to add up.
    if (start.edited(next).skin()->parts().gridRest->wrap.get() != wrap) continue;
    run.edit(next);
    run.frame();
  }
  CharacterDef last = run.character().def();
  last.skin->material.drag_Ns_per_m3 = 40;  // comes to rest sooner
  run.edit(last);
  const Character fresh = Character(start.def()).edited(last);
  const ClipSource motion = fresh.source(0);
  const Held held(motion, run.state().time_s);
  CharacterState edited = run.state(), other = initialState(fresh, held);
  ASSERT_GT(differences(*fresh.skin(), edited.skin, other.skin)[0], 1e-3);
  SkinStats stats;
  for (int f = 0; f < 300; ++f) {
    advance(run.character(), held, 1.0 / 60, edited, stats);
    advance(fresh, held, 1.0 / 60, other, stats);
  }
  const auto [largest, mean] = differences(*fresh.skin(), edited.skin, other.skin);
  // Skin in a crease between solids may come to rest on either side of it, as the torso's does.
  EXPECT_LT(largest, isTorso() ? 2e-2 : 1e-4);
  EXPECT_LT(mean, isTorso() ? 2e-3 : 2e-5);
}

INSTANTIATE_TEST_SUITE_P(Files, EditedExamples, testing::ValuesIn(test::exampleGrids()),
                         test::exampleName);

}  // namespace
}  // namespace fascia
