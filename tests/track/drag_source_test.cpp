#include <fascia/track/drag_source.h>

#include "figure.h"

namespace fascia {
namespace {

class Dragging : public testing::Test {
 protected:
  test::Figure figure;
  test::Swing walk{figure, 1, true};
  DragSource drag{figure, walk};
  const std::size_t elbow = figure.value("elbow", Dof::ry);

  test::Seen see(double time_s) const { return {figure, drag, time_s}; }
};

TEST_F(Dragging, OfNothingIsTheBase) {
  const test::Seen seen = see(0.4), base(figure, walk, 0.4);
  EXPECT_EQ(seen.sample.posture.values, base.sample.posture.values);
  EXPECT_EQ(seen.sample.posture.rates, base.sample.posture.rates);
}

TEST_F(Dragging, StartsWhereItIsWithTheSpeedItHas) {
  const test::Seen before = see(0.5);
  drag.hold(0.5, elbow, -1.5);
  drag.hold(0.5, figure.joint("shoulder"), rotationOf(Vec3(0, 2.5, 0.3)));
  const test::Seen after = see(0.5);
  for (std::size_t j = 0; j < figure.skeleton.jointCount(); ++j) {
    const Transform &a = before.posed.joint_world[j], &b = after.posed.joint_world[j];
    const Twist &v = before.posed.twist_world[j], &w = after.posed.twist_world[j];
    EXPECT_LT((a.rotation - b.rotation).norm() + (a.translation_m - b.translation_m).norm(), 1e-12);
    EXPECT_LT((v.linear_m_per_s - w.linear_m_per_s).norm(), 1e-12) << j;
    EXPECT_LT((v.angular_rad_per_s - w.angular_rad_per_s).norm(), 1e-12) << j;
  }
}

TEST_F(Dragging, ReachesWhatIsWantedAndGoesBackWhenReleased) {
  const Quat wanted = rotationOf(Vec3(0, 2.5, 0.3));
  drag.hold(0.5, elbow, -1.5);
  drag.hold(0.5, figure.joint("shoulder"), wanted);
  const double early = see(0.6).sample.posture.values[elbow];
  EXPECT_LT(early, -0.9);
  EXPECT_GT(early, -1.4);
  const test::Seen there = see(2.5);
  EXPECT_NEAR(there.sample.posture.values[elbow], -1.5, 1e-12);
  const JointId shoulder = figure.joint("shoulder"), spine = figure.joint("spine");
  const Mat3 inSpine = (there.posed.joint_world[spine.index()].rotation *
                        rotationZyx({0, 0.2, -0.3}) * wanted.toRotationMatrix());
  EXPECT_LT((there.posed.joint_world[shoulder.index()].rotation - inSpine).norm(), 1e-12);
  drag.releaseAll(2.5);
  const test::Seen back = see(5), base(figure, walk, 5);
  for (std::size_t j = 0; j < figure.skeleton.jointCount(); ++j)
    EXPECT_LT((back.posed.joint_world[j].rotation - base.posed.joint_world[j].rotation).norm(),
              1e-12);
}

TEST_F(Dragging, HasRatesThatAreDerivativesWhileTheHandMoves) {
  drag.hold(0.5, elbow, -1.5);
  drag.hold(0.5, figure.joint("shoulder"), rotationOf(Vec3(0, 2.5, 0.3)));
  test::expectRatesAreDerivatives(figure, drag, 0.55);
  drag.hold(0.6, elbow, -0.4);
  drag.hold(0.6, figure.joint("spine"), rotationOf(Vec3(0.5, 0, 0)));
  test::expectRatesAreDerivatives(figure, drag, 0.63);
  drag.release(0.7, figure.joint("shoulder"));
  test::expectRatesAreDerivatives(figure, drag, 0.71);
}

TEST_F(Dragging, StaysWithinLimits) {
  drag.hold(0, elbow, -9);
  EXPECT_NEAR(see(3).sample.posture.values[elbow], -2.5, 1e-12);
}

}  // namespace
}  // namespace fascia
