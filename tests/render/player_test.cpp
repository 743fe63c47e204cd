#include <fascia/render/player.h>
#include <gtest/gtest.h>

namespace fascia {
namespace {

CharacterDef riser() {
  CharacterDef def;
  def.name = "riser";
  JointDef& middle = def.skeleton.joints.emplace_back();
  middle.name = "middle";
  middle.dofs = {{Dof::ty}};
  FleshSolidDef& ball = def.flesh.solids.emplace_back();
  ball.name = "ball", ball.joint = "middle";
  ball.solid.shape = "sphere", ball.solid.parameters = {0.2};
  return def;
}

// Rises and swells, and is no motion of the character.
struct Rise final : PostureSource {
  void sample(double time_s, PostureSample& out) const override {
    out.posture.values = {time_s};
    out.posture.rates = {1};
    out.posture.rotations.clear();
    out.parameters = {{SolidId(0), 0, 0.2 + 0.1 * time_s, 0.1}};
  }
};

TEST(Player, ShowsWhatASourceOfOnesOwnMoved) {
  const Character character(riser());
  RecordOptions options;
  options.duration_s = 0.5;
  const Recording recording = record(character, Rise(), options);
  Player player(character, recording);
  for (const double time_s : {0.5, 0.1}) {
    player.seek(time_s);
    EXPECT_NEAR(player.state().skeleton.joint_world[0].translation_m.y(), time_s, 1e-12);
    EXPECT_NEAR(player.state().flesh.bounds(SolidId(0)).size().y(), 0.4 + 0.2 * time_s, 1e-6);
  }
  EXPECT_THROW(player.seek(0.7), Error);
}

TEST(Player, FramesWhatASourceWithoutAnEndShowsAtItsStart) {
  const Character character(riser());
  EXPECT_NEAR(motionReach(character, Rise()).box().high.y(), 0.2, 1e-6);
}

}  // namespace
}  // namespace fascia
