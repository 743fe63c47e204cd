// Seeded random edits of every example while it moves. FASCIA_EDITS=10000 makes so many of each.
#include <gtest/gtest.h>

#include <algorithm>
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
    if (sameGrid && !(wrapOf(edited) == wrapOf(character_) && fleshWentFar(state))) {
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
  const SkinStats& stats() const { return stats_; }
  bool finite() const { return finite_; }

 private:
  // A skin goes along with an edit that moves what it is tied to by more than this.
  bool fleshWentFar(const CharacterState& edited) const {
    const VectorArray &now = edited.skin.surroundings.anchor,
                      &before = state_.skin.surroundings.anchor;
    double farthest_m = 0;
    for (std::size_t k = 0; k < now.size(); ++k)
      farthest_m = std::max(farthest_m, (pointAt(now, k) - pointAt(before, k)).norm());
    return farthest_m > 0.05 * character_.skin()->size_m();
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

class EditedExamples : public testing::TestWithParam<std::string> {};

TEST_P(EditedExamples, StayWholeAndEndAsIfEditedAtOnce) {
  const Character start = test::loadExample(GetParam(), 16, 20);
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

INSTANTIATE_TEST_SUITE_P(Files, EditedExamples, testing::ValuesIn(test::exampleCharacters()),
                         test::exampleName);

}  // namespace
}  // namespace fascia
