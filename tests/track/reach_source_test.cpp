#include <fascia/track/reach_source.h>

#include "figure.h"

namespace fascia {
namespace {

const Vec3 kFingertip_m(0.1, 0, 0);

class Reaching : public testing::Test {
 protected:
  test::Figure figure;
  test::Swing walk{figure, 5, true};
  ReachSource reach{figure, walk};
  const ReachChainDef arm{figure.joint("shoulder"), figure.joint("wrist"), kFingertip_m};

  test::Seen see(const PostureSource& source, double time_s) const {
    return {figure, source, time_s};
  }
  static Vec3 fingertip(const test::Seen& seen) {
    return seen.posed.joint_world.back().point(kFingertip_m);
  }
  // Somewhere that the arm can get to, moving.
  Vec3 target(double time_s) const {
    const Vec3 shoulder_m = see(walk, time_s).posed.joint_world[2].translation_m;
    return shoulder_m + Vec3(0.2 + 0.05 * std::sin(3 * time_s), 0.1 * std::cos(2 * time_s), 0.3);
  }
  void expectWithinLimits(const test::Seen& seen) const {
    for (std::size_t v = 0; v < figure.skeleton.valueCount(); ++v) {
      const DofDef& dof = figure.skeleton.valueDof(static_cast<int>(v));
      EXPECT_GE(seen.sample.posture.values[v], dof.min) << v;
      EXPECT_LE(seen.sample.posture.values[v], dof.max) << v;
    }
  }
};

TEST_F(Reaching, GetsThereWithinLimits) {
  reach.add(arm, [this](double time_s) { return ReachGoal{.position_m = target(time_s)}; });
  for (double time_s = 0; time_s < 3; time_s += 0.1) {
    const test::Seen seen = see(reach, time_s);
    EXPECT_LT((fingertip(seen) - target(time_s)).norm(), 1e-9) << time_s;
    EXPECT_LT(reach.distance_m(0, time_s), 1e-9);
    expectWithinLimits(seen);
  }
}

TEST_F(Reaching, LeavesTheOthersAlone) {
  reach.add(arm, [this](double time_s) { return ReachGoal{.position_m = target(time_s)}; });
  const test::Seen seen = see(reach, 0.7), base = see(walk, 0.7);
  for (std::size_t j = 0; j < 2; ++j)
    EXPECT_LT((seen.posed.joint_world[j].rotation - base.posed.joint_world[j].rotation).norm(),
              1e-14);
  EXPECT_GT((fingertip(seen) - fingertip(base)).norm(), 0.05);
}

TEST_F(Reaching, HasRatesThatAreDerivatives) {
  reach.add(arm, [this](double time_s) { return ReachGoal{.position_m = target(time_s)}; });
  for (const double time_s : {0.33, 0.7, 1.9}) {
    test::expectRatesAreDerivatives(figure, reach, time_s, 1e-4, 1e-4);
    // The point moves with its target.
    const test::Seen seen = see(reach, time_s);
    const Vec3 speed = seen.posed.twist_world.back().at(fingertip(seen));
    const Vec3 wanted = (target(time_s + 1e-5) - target(time_s - 1e-5)) / 2e-5;
    EXPECT_LT((speed - wanted).norm(), 1e-4) << time_s;
  }
}

TEST_F(Reaching, TurnsTheEndAsWanted) {
  const ReachChainDef whole{figure.joint("spine"), figure.joint("wrist"), kFingertip_m};
  const Quat wanted = rotationOf(Vec3(0.3, -0.8, 0.4));
  reach.add(whole, [&](double time_s) {
    return ReachGoal{.position_m = target(time_s), .orientation = wanted};
  });
  const test::Seen seen = see(reach, 0.5);
  EXPECT_LT((fingertip(seen) - target(0.5)).norm(), 1e-8);
  EXPECT_LT((seen.posed.joint_world.back().rotation - wanted.toRotationMatrix()).norm(), 1e-8);
  expectWithinLimits(seen);
}

TEST_F(Reaching, StretchesForWhatIsOutOfReach) {
  const Vec3 far(5, 1.5, 0);
  reach.add({figure.joint("shoulder"), figure.joint("wrist"), kFingertip_m},
            [&](double) { return ReachGoal{.position_m = far}; });
  const test::Seen seen = see(reach, 0.2);
  const Vec3 shoulder = seen.posed.joint_world[2].translation_m;
  // Stretched towards it: 0.3 + 0.25 + 0.1 long when straight.
  EXPECT_GT((fingertip(seen) - shoulder).norm(), 0.64);
  EXPECT_GT((fingertip(seen) - shoulder).normalized().dot((far - shoulder).normalized()), 0.999);
  expectWithinLimits(seen);
}

TEST_F(Reaching, StopsAtLimits) {
  // Too near to the shoulder for an elbow that bends by 2.5 at most.
  reach.add(arm, [&](double time_s) {
    return ReachGoal{.position_m = see(walk, time_s).posed.joint_world[2].translation_m};
  });
  const test::Seen seen = see(reach, 0.2);
  expectWithinLimits(seen);
  EXPECT_NEAR(seen.sample.posture.values[figure.value("elbow", Dof::ry)], -2.5, 1e-9);
  EXPECT_GT(reach.distance_m(0, 0.2), 0.01);
}

TEST_F(Reaching, CountsByItsWeight) {
  double weight = 0;
  reach.add(arm, [&](double time_s) {
    return ReachGoal{.position_m = target(time_s), .weight = weight};
  });
  const Vec3 base = fingertip(see(walk, 0.7));
  EXPECT_LT((fingertip(see(reach, 0.7)) - base).norm(), 1e-12);
  weight = 0.4;
  EXPECT_LT((fingertip(see(reach, 0.7)) - (base + 0.4 * (target(0.7) - base))).norm(), 1e-9);
}

TEST_F(Reaching, RefusesChainsThatAreNone) {
  const auto goal = [](double) { return ReachGoal{}; };
  EXPECT_THROW(reach.add({figure.joint("wrist"), figure.joint("shoulder")}, goal), Error);
  EXPECT_THROW(reach.add({figure.joint("hip"), figure.joint("hip")}, goal), Error);
  EXPECT_THROW(reach.add({JointId(), JointId()}, goal), Error);
}

TEST_F(Reaching, IgnoresAGoalThatIsNone) {
  reach.add(arm, [](double) { return ReachGoal{.position_m = Vec3(0, std::nan(""), 0)}; });
  EXPECT_LT((fingertip(see(reach, 0.7)) - fingertip(see(walk, 0.7))).norm(), 1e-12);
}

}  // namespace
}  // namespace fascia
