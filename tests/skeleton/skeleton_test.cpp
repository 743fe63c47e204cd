#include <limits>

#include <fascia/base/random.h>
#include <fascia/skeleton/euler.h>
#include <fascia/skeleton/skeleton.h>
#include <gtest/gtest.h>

namespace fascia {
namespace {

JointDef joint(const char* name, const char* parent, const Vec3& offset_m,
               std::vector<DofDef> dofs = {}, const Vec3& orientation_rad = Vec3::Zero()) {
  return {name, parent, offset_m, orientation_rad, std::move(dofs)};
}

Skeleton build(const SkeletonDef& def) {
  Diagnostics diagnostics;
  Skeleton skeleton(def, "/skeleton", diagnostics);
  diagnostics.throwIfErrors();
  return skeleton;
}

std::vector<DofDef> all() {
  return {{Dof::tx}, {Dof::ty}, {Dof::tz}, {Dof::rx}, {Dof::ry}, {Dof::rz}};
}

// Branches, every kind of degree of freedom, turned rest frames.
Skeleton figure() {
  return build({{joint("hips", "", {0.1, 0.9, 0}, all(), {0.2, 0, -0.1}),
                 joint("chest", "hips", {0, 0.4, 0.02}, {{Dof::ry}, {Dof::rx}}, {0, 0.3, 0}),
                 joint("arm", "chest", {0.2, 0.1, 0}, {{Dof::rz}, {Dof::tx}}, {0.5, 0.2, 1.0}),
                 joint("hand", "arm", {0.3, 0, 0}), joint("finger", "hand", {0.05, 0, 0}, all()),
                 joint("leg", "hips", {-0.1, -0.4, 0}, {{Dof::rx}})}});
}

Posture randomPosture(const Skeleton& skeleton, std::uint64_t seed) {
  Random random(seed);
  Posture posture = skeleton.restPosture();
  for (double& value : posture.values) value = random.uniform(-2, 2);
  for (double& rate : posture.rates) rate = random.uniform(-3, 3);
  return posture;
}

TEST(Dof, NamesAreReadAndWritten) {
  for (Dof dof : {Dof::tx, Dof::ty, Dof::tz, Dof::rx, Dof::ry, Dof::rz}) {
    EXPECT_EQ(dofFromName(name(dof)), dof);
  }
  EXPECT_EQ(dofFromName("rw"), std::nullopt);
  EXPECT_EQ(dofFromName(""), std::nullopt);
}

TEST(Orientation, IsRzRyRx) {
  const Vec3 a(0.4, -0.7, 1.2);
  const Mat3 expected =
      (Eigen::AngleAxisd(a.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(a.y(), Vec3::UnitY()) *
       Eigen::AngleAxisd(a.x(), Vec3::UnitX()))
          .toRotationMatrix();
  EXPECT_LT((rotationZyx(a) - expected).norm(), 1e-14);
}

TEST(Skeleton, FindsJointsAndValues) {
  const Skeleton skeleton = figure();
  EXPECT_EQ(skeleton.jointCount(), 6u);
  EXPECT_EQ(skeleton.valueCount(), 17u);
  const JointId arm = skeleton.find("arm");
  ASSERT_TRUE(arm.valid());
  EXPECT_EQ(skeleton.parent(arm), skeleton.find("chest"));
  EXPECT_FALSE(skeleton.parent(skeleton.find("hips")).valid());
  EXPECT_FALSE(skeleton.find("tail").valid());
  const int value = skeleton.valueIndex(arm, Dof::tx);
  ASSERT_GE(value, 0);
  EXPECT_EQ(skeleton.valueJoint(value), arm);
  EXPECT_EQ(skeleton.valueDof(value).dof, Dof::tx);
  EXPECT_EQ(skeleton.valueIndex(arm, Dof::ry), -1);
  EXPECT_EQ(skeleton.valueIndex(skeleton.find("hand"), Dof::rx), -1);
}

TEST(Skeleton, StraightChainStandsAtTheSumOfItsOffsets) {
  const Skeleton skeleton = build(
      {{joint("a", "", {1, 2, 3}), joint("b", "a", {0, 1, 0}), joint("c", "b", {0, 0, 0.5})}});
  PosedSkeleton posed;
  skeleton.pose(skeleton.restPosture(), posed);
  EXPECT_LT((posed.joint_world[2].translation_m - Vec3(1, 3, 3.5)).norm(), 1e-15);
}

// An arm along x, shoulder bent 90° about z, elbow 90° about z: up, then back.
TEST(Skeleton, BentArmEndsWhereComputedByHand) {
  const Skeleton skeleton = build({{joint("shoulder", "", {0, 1, 0}, {{Dof::rz}}),
                                    joint("elbow", "shoulder", {0.3, 0, 0}, {{Dof::rz}}),
                                    joint("hand", "elbow", {0.2, 0, 0})}});
  Posture posture = skeleton.restPosture();
  posture.values = {kPi / 2, kPi / 2};
  PosedSkeleton posed;
  skeleton.pose(posture, posed);
  EXPECT_LT((posed.joint_world[1].translation_m - Vec3(0, 1.3, 0)).norm(), 1e-15);
  EXPECT_LT((posed.joint_world[2].translation_m - Vec3(-0.2, 1.3, 0)).norm(), 1e-15);
}

// Offset, then orientation, then the joint's own translation, then its rotation: with the frame
// turned 90° about y, the joint's x is the parent's -z.
TEST(Skeleton, OwnTranslationHappensInTheOrientedFrame) {
  const Skeleton skeleton =
      build({{joint("a", "", {0, 0, 1}, {{Dof::tx}, {Dof::rx}}, {0, kPi / 2, 0})}});
  Posture posture = skeleton.restPosture();
  posture.values = {0.25, kPi / 2};
  PosedSkeleton posed;
  skeleton.pose(posture, posed);
  EXPECT_LT((posed.joint_world[0].point({0, 0, 0}) - Vec3(0, 0, 0.75)).norm(), 1e-15);
  EXPECT_LT((posed.joint_world[0].vector({0, 1, 0}) - Vec3(1, 0, 0)).norm(), 1e-15);
}

TEST(Skeleton, FramesStayRigid) {
  const Skeleton skeleton = figure();
  PosedSkeleton posed;
  skeleton.pose(randomPosture(skeleton, 7), posed);
  for (const Transform& frame : posed.joint_world) {
    EXPECT_LT((frame.rotation.transpose() * frame.rotation - Mat3::Identity()).norm(), 1e-13);
    EXPECT_NEAR(frame.rotation.determinant(), 1, 1e-13);
  }
}

TEST(Skeleton, TwistsAreTheDerivativeOfTheFrames) {
  const Skeleton skeleton = figure();
  const Vec3 attached(0.3, -0.2, 0.5);
  double slowest = 1e300;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Posture posture = randomPosture(skeleton, seed);
    const auto at = [&](double time_s) {
      Posture moved = posture;
      for (std::size_t i = 0; i < moved.values.size(); ++i) {
        moved.values[i] += time_s * moved.rates[i];
      }
      PosedSkeleton posed;
      skeleton.pose(moved, posed);
      return posed;
    };
    const double h = 1e-5;
    const PosedSkeleton now = at(0), before = at(-h), after = at(h);
    for (std::size_t i = 0; i < skeleton.jointCount(); ++i) {
      const Twist& twist = now.twist_world[i];
      const auto difference = [&](const Vec3& p) -> Vec3 {
        return (after.joint_world[i].point(p) - before.joint_world[i].point(p)) / (2 * h);
      };
      EXPECT_LT((twist.origin_m - now.joint_world[i].translation_m).norm(), 1e-15);
      EXPECT_LT((twist.linear_m_per_s - difference(Vec3::Zero())).norm(), 2e-7);
      EXPECT_LT((twist.at(now.joint_world[i].point(attached)) - difference(attached)).norm(), 2e-7);
      slowest = std::min(slowest, twist.angular_rad_per_s.norm());
    }
  }
  EXPECT_GT(slowest, 0.1);
}

TEST(Skeleton, PoseDependsOnlyOnThePosture) {
  const Skeleton skeleton = figure();
  PosedSkeleton fresh, used;
  skeleton.pose(randomPosture(skeleton, 1), used);
  skeleton.pose(randomPosture(skeleton, 2), used);
  skeleton.pose(randomPosture(skeleton, 2), fresh);
  for (std::size_t i = 0; i < skeleton.jointCount(); ++i) {
    EXPECT_EQ(fresh.joint_world[i].rotation, used.joint_world[i].rotation);
    EXPECT_EQ(fresh.twist_world[i].linear_m_per_s, used.twist_world[i].linear_m_per_s);
  }
}

TEST(Skeleton, RestPostureHoldsTheRestValues) {
  const Skeleton skeleton =
      build({{joint("a", "", {0, 0, 0}, {{Dof::rx, -1, 1, 0.5}, {Dof::ty}})}});
  EXPECT_EQ(skeleton.restPosture().values, (std::vector<double>{0.5, 0}));
  EXPECT_EQ(skeleton.restPosture().rates, (std::vector<double>{0, 0}));
}

TEST(Skeleton, ClampsValuesToTheirLimitsAndStopsThem) {
  const Skeleton skeleton = build({{joint(
      "a", "", {0, 0, 0},
      {{Dof::rx, -1, 1, 0}, {Dof::ry, -1, 1, 0}, {Dof::rz, -1, 1, 0.25}, {Dof::tx, -1, 1, 0}})}});
  Posture posture;
  posture.values = {2, -3, std::numeric_limits<double>::quiet_NaN(), 0.5};
  posture.rates = {7, 7, 7, 7};
  skeleton.clampToLimits(posture);
  EXPECT_EQ(posture.values, (std::vector<double>{1, -1, 0.25, 0.5}));
  EXPECT_EQ(posture.rates, (std::vector<double>{0, 0, 0, 7}));
}

}  // namespace
}  // namespace fascia
