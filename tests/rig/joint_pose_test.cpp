#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <fascia/rig/joint_pose.h>

#include "humanoid.h"
#include "measure/shapes.h"

namespace fascia {
namespace {

using testing::ElementsAre;

const std::vector<double> kBends = {radians(90), radians(120)};

// A humanoid with a surface of two points, so that it has a size.
RiggedModel person() {
  RiggedModel model = Humanoid{.armsDown_rad = 0.6}.model();
  model.points_m = {{-0.8f, 0, 0}, {0.8f, 1.7f, 0}};
  model.weights.resize(2);
  return model;
}

std::vector<std::string> names(const std::vector<JointPose>& poses) {
  std::vector<std::string> all;
  for (const JointPose& pose : poses) all.push_back(pose.name);
  return all;
}

// Where a pose ends: the joints' frames.
std::vector<Transform> end(RiggedModel model, const JointPose& pose) {
  model.motions = {poseMotion(model, pose)};
  std::vector<Transform> world;
  poseRig(model, 0, model.motions[0].duration_s(), world);
  return world;
}

TEST(JointPoses, OfAPersonTryEveryKindOfJoint) {
  EXPECT_THAT(names(findPoses(person(), kBends)),
              ElementsAre("LeftLeg bent to 90°", "LeftLeg bent to 120°", "LeftForeArm bent to 90°",
                          "LeftForeArm bent to 120°", "LeftUpLeg raised to the front by 90°",
                          "LeftArm raised by 75°", "LeftArm twisted by 110°",
                          "LeftHand twisted by 150°", "Neck turned by 65°"));
}

TEST(JointPoses, SitRaiseTwistAndTurnAsTheirNamesSay) {
  const RiggedModel model = person();
  const std::vector<RigJoint>& joints = model.joints;
  const auto at = [&](const std::vector<Transform>& world, const std::string& name) {
    return world[jointNamed(joints, name)].translation_m;
  };
  for (const JointPose& pose : findPoses(model, {})) {
    const std::vector<Transform> world = end(model, pose);
    const Vec3 thigh = (at(world, "LeftLeg") - at(world, "LeftUpLeg")).normalized();
    const Vec3 arm = (at(world, "LeftForeArm") - at(world, "LeftArm")).normalized();
    const Mat3 moved =
        world[pose.joint].rotation * joints[pose.joint].rest_world.rotation.transpose();
    const double angle = Eigen::AngleAxisd(moved).angle();
    EXPECT_NEAR(angle, pose.angle_rad, 1e-4) << pose.name;
    if (pose.group == PoseGroup::hips) {
      EXPECT_NEAR(thigh.z(), 1, 1e-5);
    } else if (pose.name.find("raised") != std::string::npos) {
      EXPECT_NEAR(std::asin(arm.y()), -0.6 + radians(75), 1e-5);  // hung 0.6 below the horizon
      EXPECT_NEAR(arm.z(), 0, 1e-5);
    } else if (pose.group == PoseGroup::neck) {
      EXPECT_NEAR(moved.col(1).y(), 1, 1e-5);
    } else {
      EXPECT_NEAR(arm.y(), -std::sin(0.6), 1e-5) << "a twist leaves the limb where it is";
      EXPECT_TRUE(pose.twist);
    }
  }
}

TEST(JointPoses, OfAFourLegsSwingAndTurnTheHead) {
  RiggedModel model;
  const auto add = [&](const std::string& name, int parent, const Vec3& place) {
    model.joints.push_back({name, parent, {Mat3::Identity(), place}, -1});
  };
  add("root", -1, {0, 0, 0});
  add("spine", 0, {0, 0.6, 0});
  add("head", 1, {0, 0.8, 0.5});
  add("front_upper", 1, {0.15, 0.6, 0.3});
  add("front_lower", 3, {0.15, 0.3, 0.28});
  add("front_foot", 4, {0.15, 0, 0.3});
  model.points_m = {{-0.2f, 0, -0.5f}, {0.2f, 0.8f, 0.5f}};
  model.weights.resize(2);
  const std::vector<JointPose> poses = findPoses(model, {radians(90)});
  EXPECT_THAT(names(poses), ElementsAre("front_lower bent to 90°",
                                        "front_upper swung forwards by 45°", "head turned by 65°"));
  const std::vector<Transform> swung = end(model, poses[1]);
  EXPECT_GT(swung[4].translation_m.z() - swung[3].translation_m.z(), 0.15);
}

TEST(JointPoses, OfASnakeBendItsMiddle) {
  RiggedModel snake;
  for (int j = 0; j < 9; ++j)
    snake.joints.push_back(
        {"s" + std::to_string(j), j - 1, {Mat3::Identity(), {0, 0, -0.2 * j}}, -1});
  snake.points_m = {{-0.1f, 0, 0}, {0.1f, 0, -1.6f}};
  snake.weights.resize(2);
  const std::vector<JointPose> poses = findPoses(snake, kBends);
  ASSERT_THAT(names(poses), ElementsAre("s4 bent by 60°"));
  const std::vector<Transform> world = end(snake, poses[0]);
  const Vec3 before = world[4].translation_m - world[3].translation_m;
  const Vec3 after = world[5].translation_m - world[4].translation_m;
  EXPECT_NEAR(before.normalized().dot(after.normalized()), 0.5, 1e-5);
}

TEST(JointPoses, OfJointsOnOnePlaceBendTheLast) {
  RiggedModel model;
  model.joints = {{"root", -1, {}, -1}, {"tip", 0, {}, -1}};
  model.points_m = {{0, 0, 0}, {1, 1, 1}};
  model.weights.resize(2);
  model.weights[0].weight[0] = model.weights[1].weight[0] = 1;
  EXPECT_THAT(names(findPoses(model, kBends)), ElementsAre("tip bent by 60°"));
}

TEST(JointPoses, OfNothingAreNone) {
  RiggedModel model;
  model.joints = {{"root", -1, {}, -1}};
  model.points_m = {{0, 0, 0}, {1, 1, 1}};
  model.weights.resize(2);
  EXPECT_TRUE(findPoses(model, kBends).empty());
}

// A tube from x = 0 to 1 on three joints at 0, 0.4 and 0.8, weights passing from one to the next
// within 0.2, or at once.
RiggedModel arm(bool isRigid) {
  RiggedModel model;
  for (int j = 0; j < 3; ++j)
    model.joints.push_back(
        {"j" + std::to_string(j), j - 1, {Mat3::Identity(), {0.4 * j, 0, 0}}, -1});
  const TriangleMesh mesh = tube(0.05, 1, 12, 51);
  model.points_m = mesh.positions;
  model.triangles = mesh.triangles;
  for (const Eigen::Vector3f& p : mesh.positions) {
    PointWeights w;
    const float at = p.x() < 0.6f ? 0.4f : 0.8f;
    float t = std::clamp((p.x() - at) / 0.2f + 0.5f, 0.f, 1.f);
    if (isRigid) t = t > 0.5f ? 1 : 0;
    const auto upper = static_cast<std::uint16_t>(p.x() < 0.6f ? 0 : 1);
    w.joint = {upper, static_cast<std::uint16_t>(upper + 1)};
    w.weight = {1 - t, t};
    model.weights.push_back(w);
  }
  return model;
}

TEST(JointPoses, OfJointsThatAllHangOnTheRootBendTheOneThatSharesMostSkin) {
  RiggedModel model = arm(false);
  model.joints.push_back({"far", 0, {Mat3::Identity(), {9, 0, 0}}, -1});
  model.joints[2].parent = 0;
  // Joint 1 passes skin on at both of its ends, joint 2 at one, the last nowhere.
  EXPECT_THAT(names(findPoses(model, kBends)), ElementsAre("j1 bent by 60°"));
}

TEST(JointPoseRegion, IsWhatBothSidesHoldOnTo) {
  JointPose pose;
  pose.joint = 1;
  const RiggedModel model = arm(false);
  const HingeRegion region = regionOf(model, pose);
  EXPECT_EQ(region.limb.size(), model.triangles.size());
  ASSERT_FALSE(region.pointsNearJoint.empty());
  for (const std::uint32_t p : region.pointsNearJoint)
    EXPECT_NEAR(model.points_m[p].x(), 0.4, 0.1) << "not those between the next two joints";
  EXPECT_EQ(region.pointsNearJoint.size(), 9u * 12u);  // rings at 0.32 … 0.48
  EXPECT_EQ(region.nearJoint.size(), 8u * 24u);
}

TEST(JointPoseRegion, OfRigidWeightsIsWhatIsNear) {
  JointPose pose;
  pose.joint = 1;
  const RiggedModel model = arm(true);
  const HingeRegion region = regionOf(model, pose);
  ASSERT_GT(region.nearJoint.size(), 100u);
  for (const std::uint32_t p : region.pointsNearJoint)
    EXPECT_NEAR(model.points_m[p].x(), 0.4, 0.2 + 1e-6);
}

}  // namespace
}  // namespace fascia
