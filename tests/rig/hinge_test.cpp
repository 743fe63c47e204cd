#include <gtest/gtest.h>

#include <cmath>

#include <fascia/measure/deformation.h>
#include <fascia/rig/hinge.h>
#include <fascia/rig/linear_blend.h>

#include "measure/shapes.h"

namespace fascia {
namespace {

Transform at(double x, double y, double z) {
  return {Mat3::Identity(), {x, y, z}};
}

// A spine with a left arm and a left leg; names that mean nothing unless given. The arm is a tube.
RiggedModel figure(const std::string& lowerArm = "c", const std::string& lowerLeg = "f") {
  RiggedModel model;
  model.joints = {{"root", -1, at(0, 0, 0), -1},
                  {"a", 0, at(0, 1, 0), -1},
                  {"b", 1, at(0.2, 1.4, 0), -1},
                  {lowerArm, 2, at(0.6, 1.4, -0.05), -1},
                  {"d", 3, at(1, 1.4, 0), -1},
                  {"e", 0, at(0.15, 0, 0), -1},
                  {lowerLeg, 5, at(0.15, -0.5, 0.02), -1},
                  {"g", 6, at(0.15, -1, 0), -1}};
  const TriangleMesh mesh = tube(0.06, 0.8, 16, 33);
  model.triangles = mesh.triangles;
  for (const Eigen::Vector3f& p : mesh.positions) {
    model.points_m.push_back(p + Eigen::Vector3f(0.2f, 1.4f, 0));
    PointWeights weights;
    const float t = std::clamp((p.x() - 0.3f) / 0.2f, 0.f, 1.f);
    weights.joint = {static_cast<std::uint16_t>(t > 0.5f ? 3 : 2),
                     static_cast<std::uint16_t>(t > 0.5f ? 2 : 3)};
    weights.weight = {std::max(t, 1 - t), std::min(t, 1 - t)};
    model.weights.push_back(weights);
  }
  return model;
}

// The angle between the two segments of a hinge with the joints in these places.
double flexion(const std::vector<Transform>& world, std::size_t upper, std::size_t joint,
               std::size_t next) {
  const Vec3 a = world[joint].translation_m - world[upper].translation_m;
  const Vec3 b = world[next].translation_m - world[joint].translation_m;
  return std::acos(a.normalized().dot(b.normalized()));
}

TEST(Hinges, AreFoundByTheShapeOfALimb) {
  const std::vector<Hinge> hinges = findHinges(figure());
  ASSERT_EQ(hinges.size(), 2u);
  EXPECT_EQ(hinges[0].joint, 6u);  // the longer segments first
  EXPECT_EQ(hinges[1].joint, 3u);
  EXPECT_EQ(hinges[1].upper, 2u);
}

TEST(Hinges, AreFoundByNameFirst) {
  const std::vector<Hinge> hinges = findHinges(figure("LeftForeArm"), 1);
  ASSERT_EQ(hinges.size(), 1u);
  EXPECT_EQ(hinges[0].joint, 3u);
}

TEST(Hinges, AreNotFoundInASpineOrATail) {
  RiggedModel snake;
  for (int j = 0; j < 8; ++j)
    snake.joints.push_back({std::string("s") + std::to_string(j), j - 1, at(0, 0, -0.2 * j), -1});
  snake.points_m = {{-0.1f, 0, 0}, {0.1f, 0, -1.4f}};
  snake.weights.resize(2);
  EXPECT_TRUE(findHinges(snake).empty());
}

TEST(BendMotion, EndsAtTheFlexionAndMovesNothingAbove) {
  RiggedModel model = figure("LeftForeArm", "LeftLeg");
  for (const Hinge& hinge : findHinges(model))
    for (const double target : {radians(90), radians(120)}) {
      model.motions = {bendMotion(model, hinge, target)};
      std::vector<Transform> world;
      poseRig(model, 0, model.motions[0].duration_s(), world);
      EXPECT_NEAR(flexion(world, hinge.upper, hinge.joint, hinge.joint + 1), target, 1e-5);
      for (std::size_t j = 0; j < hinge.joint; ++j)
        EXPECT_LT((world[j].translation_m - model.joints[j].rest_world.translation_m).norm(), 1e-6);
      poseRig(model, 0, 0, world);
      EXPECT_NEAR(flexion(world, hinge.upper, hinge.joint, hinge.joint + 1), hinge.flexion_rad(),
                  1e-5);
    }
}

TEST(BendMotion, BendsFurtherTheWayThatTheBindPoseIsBent) {
  const RiggedModel model = figure("LeftForeArm", "LeftLeg");
  for (const Hinge& hinge : findHinges(model)) {
    // The arm's elbow stands back (-z), the hand comes forward; the knee forward, the foot back.
    const double forward = hinge.joint == 3 ? 1 : -1;
    const Vec3 lower = model.joints[hinge.joint + 1].rest_world.translation_m - hinge.center_m;
    const Vec3 bent = Eigen::AngleAxisd(radians(80), hinge.axis) * lower;
    EXPECT_GT(forward * bent.z(), 0.8 * lower.norm());
  }
}

TEST(BendMotion, OfAStretchedLimbFollowsItsMotions) {
  RiggedModel model = figure("LeftForeArm");
  model.joints[3].rest_world.translation_m.z() = 0;
  const Hinge stretched = findHinges(model, 1).front();
  // A motion of the rig that bends the elbow downwards, twisting it as well.
  SampledMotion motion = bendMotion(model, stretched, 0);
  const Vec3 down = -Vec3::UnitZ();
  for (std::size_t f = 0; f < motion.frameCount(); ++f)
    motion.rotation[f * motion.joints.size() + 3] =
        Quat(Eigen::AngleAxisd(0.02 * static_cast<double>(f % 60), down) *
             Eigen::AngleAxisd(0.3, Vec3::UnitX()))
            .cast<float>();
  model.motions = {motion};
  const Hinge hinge = findHinges(model, 1).front();
  EXPECT_GT(hinge.axis.dot(down), 0.95);
  EXPECT_NEAR(hinge.axis.dot(Vec3::UnitX()), 0, 1e-6);
}

TEST(HingeRegion, IsTheLimbAndItsMiddle) {
  const RiggedModel model = figure("LeftForeArm");
  const Hinge hinge = findHinges(model, 1).front();
  const HingeRegion region = regionOf(model, hinge);
  EXPECT_EQ(region.limb.size(), model.triangles.size());
  ASSERT_FALSE(region.pointsNearJoint.empty());
  // Half a segment either way of an arm of two: about half of the tube.
  const double share =
      static_cast<double>(region.nearJoint.size()) / static_cast<double>(region.limb.size());
  EXPECT_NEAR(share, 0.5, 0.1);
}

TEST(HingeRegion, LosesVolumeUnderLinearBlending) {
  RiggedModel model = figure("LeftForeArm");
  const Hinge hinge = findHinges(model, 1).front();
  const HingeRegion region = regionOf(model, hinge);
  model.motions = {bendMotion(model, hinge, radians(120))};
  std::vector<Transform> world, motion;
  poseRig(model, 0, 2, world);
  restToFrame(model, world, motion);
  std::vector<Eigen::Vector3f> points(model.points_m.size());
  LinearBlend(model).deform(motion, points);
  const double loss = jointVolumeLoss(region.limb, region.nearJoint, model.points_m, points);
  EXPECT_GT(loss, 0.05);
  EXPECT_LT(loss, 0.6);
}

}  // namespace
}  // namespace fascia
