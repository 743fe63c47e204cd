#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fascia/base/error.h>
#include <fascia/rig/retarget.h>
#include <fascia/rig/retarget_legs.h>

#include "rig/humanoid.h"

namespace fascia {
namespace {

constexpr RetargetOptions kAsRecorded{SourceRest::bind, false, false};

// Bones by the joints at their ends.
const std::vector<std::pair<std::string, std::string>> kLimbs = {
    {"LeftArm", "LeftForeArm"},    {"LeftForeArm", "LeftHand"}, {"RightArm", "RightForeArm"},
    {"RightForeArm", "RightHand"}, {"LeftUpLeg", "LeftLeg"},    {"LeftLeg", "LeftFoot"},
    {"RightUpLeg", "RightLeg"},    {"RightLeg", "RightFoot"}};

SampledMotion onto(RiggedModel& model, const MotionFigure& figure,
                   const RetargetOptions& options = kAsRecorded) {
  const JointMap map = guessJointMap(figure.joints, model.joints);
  model.motions = {retarget(figure, model, map, options)};
  return model.motions[0];
}

// World frames of the model in a frame of its only motion.
std::vector<Transform> posed(const RiggedModel& model, std::size_t frame) {
  std::vector<Transform> world;
  poseRig(model, 0, static_cast<double>(frame) / model.motions[0].rate_hz, world);
  return world;
}

Vec3 placeOf(const std::vector<RigJoint>& joints, const std::vector<Transform>& world,
             const std::string& name) {
  return world[jointNamed(joints, name)].translation_m;
}

double largestLimbError(const MotionFigure& figure, const RiggedModel& model, const Mat3& turned) {
  double largest = 0;
  std::vector<Transform> source;
  for (std::size_t f = 0; f < figure.motion.frameCount(); ++f) {
    poseFigure(figure, f, source);
    const std::vector<Transform> target = posed(model, f);
    for (const auto& [from, to] : kLimbs) {
      const Vec3 recorded =
          placeOf(figure.joints, source, to) - placeOf(figure.joints, source, from);
      const Vec3 ours = placeOf(model.joints, target, to) - placeOf(model.joints, target, from);
      largest = std::max(largest, (turned * recorded.normalized() - ours.normalized()).norm());
    }
  }
  return largest;
}

TEST(Retarget, GivesIdenticalSkeletonsTheMotionBack) {
  for (const bool oddFrames : {false, true}) {
    Humanoid human;
    human.oddFrames = oddFrames;
    const MotionFigure figure = dancing(human, 0.6);
    RiggedModel model = human.model();
    const SampledMotion got = onto(model, figure, {SourceRest::bind, false, true});
    ASSERT_EQ(got.frameCount(), figure.motion.frameCount());
    ASSERT_EQ(got.joints, figure.motion.joints);
    for (std::size_t i = 0; i < got.rotation.size(); ++i) {
      ASSERT_LT(got.rotation[i].angularDistance(figure.motion.rotation[i]), 2e-5f);
      ASSERT_LT((got.translation_m[i] - figure.motion.translation_m[i]).norm(), 1e-5f);
    }
  }
}

TEST(Retarget, GivesTurnedJointFramesTheSameLimbDirections) {
  const MotionFigure figure = dancing(Humanoid{}, 0.8);
  Humanoid odd;
  odd.oddFrames = true;
  odd.size = 1.3;
  RiggedModel model = odd.model();
  onto(model, figure);
  EXPECT_LT(largestLimbError(figure, model, Mat3::Identity()), 1e-5);
}

TEST(Retarget, LetsATPoseDriveAnAPose) {
  const MotionFigure figure = dancing(Humanoid{}, 0.8);
  Humanoid apart;
  apart.armsDown_rad = radians(45);
  apart.legsApart_rad = radians(12);
  apart.oddFrames = true;
  RiggedModel model = apart.model();
  onto(model, figure);
  EXPECT_LT(largestLimbError(figure, model, Mat3::Identity()), 1e-5);

  // Standing still in the source's rest pose lifts the arms to a T and keeps the soles flat.
  const MotionFigure still = dancing(Humanoid{}, 0);
  onto(model, still);
  const std::vector<Transform> world = posed(model, 0);
  EXPECT_NEAR(placeOf(model.joints, world, "LeftHand").y(),
              placeOf(model.joints, world, "LeftArm").y(), 1e-5);
  const std::size_t foot = jointNamed(model.joints, "LeftFoot");
  EXPECT_TRUE(world[foot].rotation.isApprox(model.joints[foot].rest_world.rotation, 1e-5));
}

TEST(Retarget, KeepsTheTwistOfABone) {
  const double twist = radians(40);
  MotionFigure figure = dancing(Humanoid{}, 0, 2);
  const std::size_t count = figure.joints.size(), arm = jointNamed(figure.joints, "LeftForeArm");
  figure.motion.rotation[count + arm] = Quat(turn(Vec3::UnitX(), twist)).cast<float>();
  Humanoid down;
  down.armsDown_rad = radians(30);
  down.oddFrames = true;
  RiggedModel model = down.model();
  onto(model, figure);
  const std::size_t ours = jointNamed(model.joints, "LeftForeArm");
  const Mat3 change = posed(model, 1)[ours].rotation * posed(model, 0)[ours].rotation.transpose();
  EXPECT_TRUE(change.isApprox(turn(Vec3::UnitX(), twist), 1e-5));
}

TEST(Retarget, TurnsAFigureThatLiesOnItsBackAndFacesElsewhere) {
  Humanoid lying;
  lying.turned = turn(Vec3::UnitX(), kPi / 2) * turn(Vec3::UnitY(), kPi / 2);  // z is up
  const MotionFigure figure = dancing(lying, 0.7);
  Humanoid human;
  human.armsDown_rad = radians(20);
  RiggedModel model = human.model();
  onto(model, figure);
  EXPECT_LT(largestLimbError(figure, model, lying.turned.transpose()), 1e-5);
}

TEST(Retarget, ScalesThePathByTheLegs) {
  const MotionFigure figure = dancing(Humanoid{}, 0.3);
  Humanoid tall;
  tall.size = 2.5;
  RiggedModel model = tall.model();
  const SampledMotion got = onto(model, figure);
  const std::size_t last = (got.frameCount() - 1) * got.joints.size();
  const Eigen::Vector3f recorded =
      figure.motion.translation_m[last] - figure.motion.translation_m[0];
  EXPECT_GT(recorded.norm(), 0.5f);
  EXPECT_LT((got.translation_m[last] - got.translation_m[0] - 2.5f * recorded).norm(), 1e-4f);
}

TEST(Retarget, StartsWhereTheRigStands) {
  MotionFigure figure = dancing(Humanoid{}, 0);
  for (Eigen::Vector3f& t : figure.motion.translation_m) t += Eigen::Vector3f(0, 0, 0);
  for (std::size_t f = 0; f < figure.motion.frameCount(); ++f) {
    figure.motion.translation_m[f * figure.joints.size()] = {5, 3, -4};
  }
  Humanoid other;
  other.shinShare = 0.55;
  other.size = 0.4;
  RiggedModel model = other.model();
  onto(model, figure, {SourceRest::bind, true, true});
  const std::vector<Transform> world = posed(model, 0);
  for (const std::size_t j :
       {jointNamed(model.joints, "Hips"), jointNamed(model.joints, "LeftToeBase")}) {
    EXPECT_LT((world[j].translation_m - model.joints[j].rest_world.translation_m).norm(), 1e-5);
  }
}

// The source's ball of the foot in its scaled world, and where ours is relative to it.
double largestFootSlide(const MotionFigure& figure, const RiggedModel& model, double scale) {
  double largest = 0;
  Vec3 first = Vec3::Zero();
  for (std::size_t f = 0; f < figure.motion.frameCount(); ++f) {
    std::vector<Transform> source;
    poseFigure(figure, f, source);
    const Vec3 apart = placeOf(model.joints, posed(model, f), "LeftToeBase") -
                       scale * placeOf(figure.joints, source, "LeftToeBase");
    if (f == 0) first = apart;
    largest = std::max(largest, (apart - first).norm());
  }
  return largest;
}

// Knees bend to and fro, all other joints rest: thigh forward, shin backward.
MotionFigure squatting() {
  MotionFigure figure = dancing(Humanoid{}, 0, 25);
  const std::size_t count = figure.joints.size();
  for (std::size_t f = 0; f < figure.motion.frameCount(); ++f) {
    const double bend = 0.5 + 0.3 * std::sin(0.5 * static_cast<double>(f));
    for (const std::string side : {"Left", "Right"}) {
      const auto set = [&](const std::string& joint, double angle) {
        figure.motion.rotation[f * count + jointNamed(figure.joints, side + joint)] =
            Quat(turn(Vec3::UnitX(), angle)).cast<float>();
      };
      set("UpLeg", -0.8 * bend);
      set("Leg", 1.5 * bend);
      set("Foot", -0.7 * bend);
    }
  }
  return figure;
}

TEST(Retarget, PlantsFeetOfOtherProportions) {
  const MotionFigure figure = squatting();
  Humanoid other;
  other.shinShare = 0.4;
  other.armsDown_rad = 0.7;
  RiggedModel model = other.model();
  onto(model, figure, {SourceRest::bind, false, false});
  const double before = largestFootSlide(figure, model, 1);
  onto(model, figure, {SourceRest::bind, false, true});
  const double after = largestFootSlide(figure, model, 1);
  EXPECT_GT(before, 0.02);
  EXPECT_LT(after, 1e-5);
}

TEST(Retarget, BendsATrunkOfMoreJointsEvenly) {
  Humanoid stiff;
  stiff.spines = 1;
  MotionFigure figure = dancing(stiff, 0, 2);
  const std::size_t count = figure.joints.size(), spine = jointNamed(figure.joints, "Spine0");
  figure.motion.rotation[count + spine] = Quat(turn(Vec3::UnitX(), 0.9)).cast<float>();
  Humanoid supple;
  supple.spines = 3;
  RiggedModel model = supple.model();
  onto(model, figure);
  const std::vector<Transform> world = posed(model, 1);
  for (int s = 0; s < 3; ++s) {
    const std::size_t j = jointNamed(model.joints, "Spine" + std::to_string(s));
    EXPECT_TRUE(world[j].rotation.isApprox(turn(Vec3::UnitX(), 0.3 * (s + 1)), 1e-5)) << s;
  }
}

TEST(Retarget, SplitsATwistButNotABendOverALimbOfMoreBones) {
  MotionFigure figure = dancing(Humanoid{}, 0, 2);
  const std::size_t count = figure.joints.size(), arm = jointNamed(figure.joints, "LeftArm");
  const Mat3 swing = turn(Vec3::UnitZ(), -0.6);
  figure.motion.rotation[count + arm] = Quat(swing * turn(Vec3::UnitX(), 0.8)).cast<float>();
  Humanoid split;
  split.upperArms = 2;
  RiggedModel model = split.model();
  onto(model, figure);
  const std::vector<Transform> world = posed(model, 1);
  EXPECT_TRUE(world[jointNamed(model.joints, "LeftArm")].rotation.isApprox(
      swing * turn(Vec3::UnitX(), 0.4), 1e-5));
  EXPECT_TRUE(world[jointNamed(model.joints, "LeftArm02")].rotation.isApprox(
      swing * turn(Vec3::UnitX(), 0.8), 1e-5));
}

TEST(Retarget, TakesACalibrationStanceInTheFirstFrameAsRestPose) {
  Humanoid splayed;
  splayed.legsApart_rad = radians(20);
  MotionFigure figure = dancing(splayed, 0, 3);
  const std::size_t count = figure.joints.size();
  for (const auto& [name, angle] : {std::pair{"LeftUpLeg", -20.0},
                                    {"LeftFoot", 20.0},
                                    {"RightUpLeg", 20.0},
                                    {"RightFoot", -20.0}}) {
    figure.motion.rotation[jointNamed(figure.joints, name)] =
        Quat(turn(Vec3::UnitZ(), radians(angle))).cast<float>();
    figure.motion.rotation[count + jointNamed(figure.joints, name)] =
        figure.motion.rotation[jointNamed(figure.joints, name)];
  }
  RiggedModel model = Humanoid{}.model();
  std::vector<std::string> notes;
  const JointMap map = guessJointMap(figure.joints, model.joints);
  model.motions = {retarget(figure, model, map, {}, &notes)};
  EXPECT_EQ(model.motions[0].frameCount(), 2u);
  EXPECT_THAT(notes, testing::Contains(testing::HasSubstr("calibration")));
  // What stands like the first frame stands like the rig.
  const std::vector<Transform> world = posed(model, 0);
  for (std::size_t j = 0; j < world.size(); ++j) {
    EXPECT_TRUE(world[j].rotation.isApprox(model.joints[j].rest_world.rotation, 1e-5)) << j;
  }
}

TEST(Retarget, LeavesUndrivenJointsOnTheirParents) {
  const MotionFigure figure = dancing(Humanoid{}, 0.5);
  RiggedModel model = Humanoid{}.model();
  const int head = static_cast<int>(jointNamed(model.joints, "Head"));
  model.joints.push_back({"hat", head, {turn(Vec3::UnitY(), 1), Vec3(0.1, 1.9, 0.2)}, -1});
  const SampledMotion got = onto(model, figure);
  const std::size_t hat = model.joints.size() - 1;
  for (std::size_t f = 1; f < got.frameCount(); ++f) {
    const std::size_t i = f * got.joints.size() + hat;
    EXPECT_LT(got.rotation[i].angularDistance(got.rotation[hat]), 1e-5f);
    EXPECT_LT((got.translation_m[i] - got.translation_m[hat]).norm(), 1e-5f);
  }
}

TEST(Retarget, PutsOneRigsMotionOnAnother) {
  Humanoid from;
  from.oddFrames = true;
  RiggedModel source = from.model();
  source.motions = {dancing(from, 0.4).motion};
  Humanoid to;
  to.armsDown_rad = 0.8;
  RiggedModel model = to.model();
  const MotionFigure figure = figureOf(source, 0);
  onto(model, figure);
  EXPECT_LT(largestLimbError(figure, model, Mat3::Identity()), 1e-5);
}

TEST(Retarget, RefusesAMapThatDrivesNothing) {
  EXPECT_THROW(retarget(dancing(Humanoid{}, 0), Humanoid{}.model(), {}), Error);
}

TEST(Leg, ReachesItsGoalAndKeepsItsLengths) {
  const Vec3 hip(0.1, 0.9, 0), knee(0.1, 0.5, 0.05), ankle(0.12, 0.1, -0.02);
  for (const Vec3& goal : {Vec3(0.1, 0.2, 0.1), Vec3(0.3, 0.15, -0.2), Vec3(0.05, 0.12, 0.1)}) {
    const LegTurns turns = reach(hip, knee, ankle, Vec3::UnitX(), goal);
    const Vec3 newKnee = hip + turns.upper * (knee - hip);
    EXPECT_LT((newKnee + turns.lower * (ankle - knee) - goal).norm(), 1e-9);
    EXPECT_GT((newKnee - 0.5 * (hip + goal)).z(), 0);  // knees bend forward
  }
  const LegTurns none = reach(hip, knee, ankle, Vec3::UnitX(), ankle);
  EXPECT_TRUE(none.upper.isIdentity(1e-9) && none.lower.isIdentity(1e-9));
}

TEST(Leg, StretchesTowardsWhatIsTooFar) {
  const Vec3 hip(0, 1, 0), knee(0, 0.5, 0.1), ankle(0, 0.1, 0), goal(0, -3, 1);
  const LegTurns turns = reach(hip, knee, ankle, Vec3::UnitX(), goal);
  const Vec3 got = turns.upper * (knee - hip) + turns.lower * (ankle - knee);
  EXPECT_LT(got.normalized().cross((goal - hip).normalized()).norm(), 1e-9);
  EXPECT_GT(got.norm(), 0.99 * ((knee - hip).norm() + (ankle - knee).norm()));
}

}  // namespace
}  // namespace fascia
