#include <algorithm>
#include <cmath>
#include <limits>

#include <fascia/base/random.h>
#include <fascia/skeleton/euler.h>
#include <fascia/skeleton/skeleton.h>
#include <gtest/gtest.h>

namespace fascia {
namespace {

constexpr double kTumbleFrame_s = 1.0 / 240;
const Transform kTumblerRest{rotationZyx({0.2, -0.4, 0.7}), {0.1, 1, -0.2}};

// A ball joint on a turned base, an elbow on it.
Skeleton tumbler(double limit_rad = 1e9) {
  const std::vector<DofDef> ball = {{Dof::rx, -limit_rad, limit_rad},
                                    {Dof::ry, -limit_rad, limit_rad},
                                    {Dof::rz, -limit_rad, limit_rad}};
  Diagnostics diagnostics;
  Skeleton skeleton({{{"ball", "", {0.1, 1, -0.2}, {0.2, -0.4, 0.7}, ball},
                      {"elbow", "ball", {0.3, 0, 0}, {0, 0, 0}, {{Dof::rz}}}}},
                    "/skeleton", diagnostics);
  diagnostics.throwIfErrors();
  return skeleton;
}

JointRotation turnAbout(const Vec3& axis, double angle_rad, double rate_rad_per_s) {
  return {JointId(0), Quat(Eigen::AngleAxisd(angle_rad, axis)), rate_rad_per_s * axis};
}

// What a tumble showed at its worst.
struct Tumble {
  double frameError = 0;  // of the joint's world frame
  double valueError = 0;  // of the frame that the angles alone give
  double spinError = 0;   // of its angular velocity, 1/s
  double spinJump = 0;    // from frame to frame, 1/s
  double angleJump = 0;   // of any angle from frame to frame
  double middle_rad = 0;  // the largest middle angle
};

// Two turns about an axis with a speed that changes smoothly.
Tumble tumble(const Vec3& axis) {
  const Skeleton skeleton = tumbler();
  Tumble worst;
  Posture posture = skeleton.restPosture();
  PosedSkeleton posed, byAngles;
  Vec3 spinBefore = Vec3::Zero();
  std::vector<double> before = posture.values;
  for (int f = 0; f <= 960; ++f) {
    const double t = f * kTumbleFrame_s;
    const double angle = kPi * t + 0.3 * std::sin(2 * t), rate = kPi + 0.6 * std::cos(2 * t);
    posture.rotations = {turnAbout(axis, angle, rate)};
    skeleton.resolveRotations(before, posture);
    EXPECT_EQ(posture.rotations.size(), 1u);
    skeleton.pose(posture, posed);
    Posture plain = posture;
    plain.rotations.clear();
    skeleton.pose(plain, byAngles);
    const Mat3 wanted = kTumblerRest.rotation * Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    const Vec3 spin = kTumblerRest.rotation * (rate * axis);
    worst.frameError = std::max(worst.frameError, (posed.joint_world[0].rotation - wanted).norm());
    worst.valueError =
        std::max(worst.valueError, (byAngles.joint_world[0].rotation - wanted).norm());
    worst.spinError =
        std::max(worst.spinError, (posed.twist_world[0].angular_rad_per_s - spin).norm());
    for (std::size_t i = 0; i < 3; ++i)
      worst.angleJump = std::max(worst.angleJump, std::abs(posture.values[i] - before[i]));
    if (f > 0)
      worst.spinJump =
          std::max(worst.spinJump, (posed.twist_world[0].angular_rad_per_s - spinBefore).norm());
    worst.middle_rad = std::max(worst.middle_rad, posture.values[1]);
    spinBefore = posed.twist_world[0].angular_rad_per_s;
    before = posture.values;
  }
  return worst;
}

TEST(JointRotation, TumblesThroughTheMiddleAxisWithoutAJump) {
  const Tumble seen = tumble(Vec3::UnitY());
  EXPECT_LT(seen.frameError, 1e-14);
  EXPECT_LT(seen.valueError, 1e-12);
  EXPECT_LT(seen.spinError, 1e-13);
  EXPECT_LT(seen.spinJump, 1.3 * kTumbleFrame_s);  // the speed changes by 1.2 at most
  EXPECT_LT(seen.angleJump, 4 * kTumbleFrame_s);   // and the angles go on where they were
  EXPECT_GT(seen.middle_rad, 3.5 * kPi);           // all the way round, twice
}

TEST(JointRotation, FollowsAnyAxisExactly) {
  for (const Vec3& axis : {Vec3(0.01, 1, -0.02), Vec3(0.3, 0.8, 0.5), Vec3(1, 1, 0)}) {
    const Tumble seen = tumble(axis.normalized());
    EXPECT_LT(seen.frameError, 1e-14);
    EXPECT_LT(seen.valueError, 1e-12);
    EXPECT_LT(seen.spinError, 1e-13);
    EXPECT_LT(seen.spinJump, 1.3 * kTumbleFrame_s);
  }
}

TEST(JointRotation, MovesWhatHangsOnTheJointAsItsFrameMoves) {
  const Skeleton skeleton = tumbler();
  const Vec3 axis = Vec3(0.2, 1, 0.1).normalized();
  const auto at = [&](double t) {
    Posture posture = skeleton.restPosture();
    posture.rotations = {turnAbout(axis, 1.5 + 2 * t, 2)};
    skeleton.resolveRotations({}, posture);
    PosedSkeleton posed;
    skeleton.pose(posture, posed);
    return posed;
  };
  const PosedSkeleton now = at(0);
  const Vec3 moved =
      (at(1e-5).joint_world[1].translation_m - at(-1e-5).joint_world[1].translation_m) / 2e-5;
  ASSERT_GT(moved.norm(), 0.1);
  EXPECT_LT((now.twist_world[1].linear_m_per_s - moved).norm(), 1e-8);
}

TEST(JointRotation, RatesOfTheAnglesAreTheirDerivatives) {
  const Skeleton skeleton = tumbler();
  const Vec3 axis = Vec3(0.5, 0.3, -0.8).normalized();
  Posture at[3];
  for (int i = 0; i < 3; ++i) {
    at[i] = skeleton.restPosture();
    at[i].rotations = {turnAbout(axis, 1.1 + 1.7e-5 * (i - 1), 1.7)};
    skeleton.resolveRotations({}, at[i]);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const double slope = (at[2].values[k] - at[0].values[k]) / 2e-5;
    ASSERT_GT(std::abs(slope), 0.01);
    EXPECT_NEAR(at[1].rates[k], slope, 1e-5);
  }
}

TEST(JointRotation, IsNearestToTheAnglesBefore) {
  Random random(7);
  for (int i = 0; i < 200; ++i) {
    const Vec3 angles(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9));
    const Vec3 near = angles + 0.01 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), 0.5);
    EXPECT_LT((anglesZyxNear(rotationZyx(angles), near) - angles).norm(), 1e-9) << angles;
  }
}

TEST(JointRotation, SharesWhatOnlyTheSumOfTwoAnglesSays) {
  for (const double side : {-1.0, 1.0}) {
    const Vec3 angles(0.4, side * kPi / 2, -0.3), near(0.5, side * 1.5, -0.1);
    const Vec3 found = anglesZyxNear(rotationZyx(angles), near);
    EXPECT_LT((rotationZyx(found) - rotationZyx(angles)).norm(), 1e-14);
    EXPECT_NEAR(std::abs(found.x() - near.x()), std::abs(found.z() - near.z()), 1e-14);
    EXPECT_LT((found - near).norm(), (angles - near).norm());
  }
}

TEST(JointRotation, StopsAtLimitsLikeAngles) {
  const Skeleton skeleton = tumbler(0.5);
  Posture posture = skeleton.restPosture();
  posture.rotations = {turnAbout(Vec3::UnitX(), 0.8, 1)};
  skeleton.resolveRotations({}, posture);
  skeleton.clampToLimits(posture);
  EXPECT_TRUE(posture.rotations.empty());
  EXPECT_NEAR(posture.values[0], 0.5, 1e-12);
  EXPECT_EQ(posture.rates[0], 0);
  // Wound up to the limit by whole turns it unwinds.
  posture.rotations = {turnAbout(Vec3::UnitX(), 0.4, 1)};
  const std::vector<double> wound = {6.2, 0, 0, 0};
  skeleton.resolveRotations(wound, posture);
  ASSERT_EQ(posture.rotations.size(), 1u);
  EXPECT_NEAR(posture.values[0], 0.4, 1e-12);
}

TEST(JointRotation, OfAHingeIsItsAngle) {
  const Skeleton skeleton = tumbler();
  Posture posture = skeleton.restPosture();
  posture.rotations = {{JointId(1), Quat(Eigen::AngleAxisd(0.6, Vec3::UnitZ())), {0, 0, 2.5}}};
  skeleton.resolveRotations({}, posture);
  EXPECT_TRUE(posture.rotations.empty());
  EXPECT_NEAR(posture.values[3], 0.6, 1e-12);
  EXPECT_NEAR(posture.rates[3], 2.5, 1e-4);
}

TEST(JointRotation, ThatIsNoneIsDropped) {
  const Skeleton skeleton = tumbler();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Posture posture = skeleton.restPosture();
  posture.rotations = {{JointId(0), Quat(0, 0, 0, 0), Vec3::Zero()},
                       {JointId(0), Quat(nan, 0, 0, 1), Vec3::Zero()},
                       {JointId(5), Quat::Identity(), Vec3::Zero()},
                       {JointId(), Quat::Identity(), Vec3::Zero()},
                       {JointId(0), Quat(2, 0, 0, 0), Vec3(nan, 0, 0)}};
  skeleton.resolveRotations({}, posture);
  EXPECT_TRUE(posture.rotations.empty());
  EXPECT_EQ(posture.values, skeleton.restPosture().values);
}

}  // namespace
}  // namespace fascia
