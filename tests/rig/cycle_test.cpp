#include <fascia/rig/cycle.h>

#include <gtest/gtest.h>

#include <cmath>

namespace fascia {
namespace {

// A root that stays, hips that walk and turn, and a leg that swings; the hips' parent is turned, so
// that its axes are not the world's.
RiggedModel walker(const Vec3& travel_m, double last_rad) {
  constexpr std::size_t kFrames = 21;
  RiggedModel model;
  const Mat3 turned = Eigen::AngleAxisd(0.7, Vec3::UnitX()).toRotationMatrix();
  model.joints = {{"root", -1, {turned, Vec3::Zero()}},
                  {"hips", 0, {turned, Vec3(0, 1, 0)}},
                  {"leg", 1, {turned, Vec3(0, 0.5, 0)}}};
  model.points_m = {{0, 1, 0}, {0, 0, 0}, {0.2f, 0.5f, 0}};
  model.weights.resize(3);
  model.weights[0].joint[0] = 1;
  model.weights[1].joint[0] = model.weights[2].joint[0] = 2;
  for (PointWeights& w : model.weights) w.weight[0] = 1;
  SampledMotion motion;
  motion.name = "walk";
  motion.rate_hz = 20;
  motion.joints = {"root", "hips", "leg"};
  for (std::size_t f = 0; f < kFrames; ++f) {
    const double t = static_cast<double>(f) / (kFrames - 1);
    const Transform hips_world{
        Eigen::AngleAxisd(0.2 * std::sin(2 * kPi * t), Vec3::UnitY()).toRotationMatrix() * turned,
        Vec3(0, 1 + 0.05 * std::sin(4 * kPi * t), 0) + t * travel_m};
    const double swing = 0.5 * std::sin(2 * kPi * t) + t * last_rad;
    const Transform locals[] = {
        {turned, Vec3::Zero()},
        Transform{turned, Vec3::Zero()}.inverse() * hips_world,
        {Eigen::AngleAxisd(swing, Vec3::UnitX()).toRotationMatrix(), Vec3(0, -0.5, 0)}};
    for (const Transform& local : locals) {
      motion.rotation.push_back(Quat(local.rotation).cast<float>());
      motion.translation_m.push_back(local.translation_m.cast<float>());
    }
  }
  model.motions = {motion};
  return model;
}

TEST(MotionCycle, IsFoundThroughTheTravel) {
  const Vec3 travel(0.1, 0, 2);
  const auto cycle = cycleOf(walker(travel, 0), 0);
  ASSERT_TRUE(cycle);
  EXPECT_LT((cycle->travel_m - travel).norm(), 1e-6);
}

TEST(MotionCycle, EndsInAnotherPoseAreNone) {
  EXPECT_FALSE(cycleOf(walker({0, 0, 2}, 0.1), 0));
  EXPECT_FALSE(cycleOf(walker({0, 0, 0}, -0.1), 0));
  EXPECT_TRUE(cycleOf(walker({0, 0, 0}, 0), 0));
}

TEST(MotionCycle, LoopsAreCyclesThatStay) {
  RiggedModel model = walker({0, 0, 0}, 0.5);
  model.motions[0].loop = true;
  const auto cycle = cycleOf(model, 0);
  ASSERT_TRUE(cycle);
  EXPECT_TRUE(cycle->travel_m.isZero(0));
}

// Without the doubled pose at its end, a cycle is a frame longer than the motion.
TEST(MotionCycle, MayLackItsLastPose) {
  RiggedModel model = walker({0, 0, 0}, 0);
  SampledMotion& motion = model.motions[0];
  motion.rotation.resize(motion.rotation.size() - 3);
  motion.translation_m.resize(motion.translation_m.size() - 3);
  const auto cycle = cycleOf(model, 0);
  ASSERT_TRUE(cycle);
  EXPECT_NEAR(cycle->period_s, 1, 1e-9);
  EXPECT_NEAR(motion.duration_s(), 0.95, 1e-9);
  const SampledMotion twice = playedTwice(model, 0, *cycle);
  EXPECT_EQ(twice.frameCount(), 41u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(twice.translation_m[20 * 3 + i], twice.translation_m[i]);
    EXPECT_EQ(twice.translation_m[40 * 3 + i], twice.translation_m[i]);
  }
  // Two frames short it does not close.
  motion.rotation.resize(motion.rotation.size() - 6);
  motion.translation_m.resize(motion.translation_m.size() - 6);
  EXPECT_FALSE(cycleOf(model, 0));
}

TEST(PlayedTwice, GoesOnFromWhereItHasGotTo) {
  const Vec3 travel(0.1, 0.02, 2);
  RiggedModel model = walker(travel, 0);
  const MotionCycle cycle = *cycleOf(model, 0);
  model.motions.push_back(playedTwice(model, 0, cycle));
  EXPECT_EQ(model.motions[1].frameCount(), 41u);
  EXPECT_NEAR(cycle.period_s, model.motions[0].duration_s(), 1e-12);
  EXPECT_NEAR(model.motions[1].duration_s(), 2 * cycle.period_s, 1e-12);
  std::vector<Transform> once, again;
  for (int f = 0; f <= 20; ++f) {
    poseRig(model, 0, f / 20.0, once);
    poseRig(model, 1, 1 + f / 20.0, again);
    for (std::size_t j = 0; j < once.size(); ++j) {
      const Vec3 shift = j == 0 ? Vec3::Zero() : travel;  // the root has stayed where it was
      EXPECT_LT((again[j].translation_m - once[j].translation_m - shift).norm(), 1e-5) << f;
      EXPECT_LT((again[j].rotation - once[j].rotation).norm(), 1e-5) << f;
    }
  }
}

}  // namespace
}  // namespace fascia
