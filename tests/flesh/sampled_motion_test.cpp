#include <gtest/gtest.h>

#include <cmath>

#include <fascia/base/random.h>
#include <fascia/flesh/bind.h>
#include <fascia/skeleton/euler.h>

namespace fascia {
namespace {

constexpr std::size_t kJoints = 3;
const std::array<std::string, kJoints> kNames{"root", "arm", "hand"};

Transform anyTransform(Random& random, double turn_rad, double shift_m) {
  const Vec3 axis(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  const Vec3 shift(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  const double angle = random.uniform(-turn_rad, turn_rad);
  return {Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(), shift_m * shift};
}

// A chain of three joints that moves about its rest pose, and a skeleton of the same joints whose
// frames stand turned and shifted in the rig's.
struct Puppet {
  std::array<Transform, kJoints> rigRest, change;  // change: from the rig's frame to the skeleton's
  std::shared_ptr<SampledMotion> motion = std::make_shared<SampledMotion>();
  std::vector<SampledFrame> frames;
  SkeletonDef skeletonDef;
  Skeleton skeleton;

  explicit Puppet(bool loop, double turn_rad = 0.5) {
    Random random(23);
    for (std::size_t j = 0; j < kJoints; ++j) {
      rigRest[j] = anyTransform(random, 3, 0.5);
      change[j] = anyTransform(random, 3, 0.1);
    }
    makeMotion(random, loop, turn_rad);
    makeSkeleton();
  }
  Transform restInParent(std::size_t j) const {
    return j == 0 ? rigRest[0] : rigRest[j - 1].inverse() * rigRest[j];
  }
  void makeMotion(Random& random, bool loop, double turn_rad) {
    motion->name = "dance";
    motion->rate_hz = 20;
    motion->loop = loop;
    motion->joints.assign(kNames.begin(), kNames.end());
    for (int f = 0; f < 10; ++f) {
      for (std::size_t j = 0; j < kJoints; ++j) {
        const Transform t = restInParent(j) * anyTransform(random, turn_rad, 0.1);
        motion->rotation.emplace_back(Quat(t.rotation).cast<float>());
        motion->translation_m.push_back(t.translation_m.cast<float>());
        frames.resize(kJoints);
        frames[j] = {kNames[j], j == 0 ? "" : kNames[j - 1], rigRest[j]};
      }
    }
  }
  void makeSkeleton() {
    for (std::size_t j = 0; j < kJoints; ++j) {
      Transform local = rigRest[j] * change[j];
      if (j > 0) local = (rigRest[j - 1] * change[j - 1]).inverse() * local;
      skeletonDef.joints.push_back(
          {kNames[j],
           j == 0 ? "" : kNames[j - 1],
           local.translation_m,
           anglesZyx(local.rotation),
           {{Dof::tx}, {Dof::ty}, {Dof::tz}, {Dof::rx}, {Dof::ry}, {Dof::rz}}});
    }
  }
  BoundClip bind(Diagnostics& diagnostics) {
    skeleton = Skeleton(skeletonDef, "/skeleton", diagnostics);
    return bindSampled(motion, frames, {skeleton, Flesh(), Morphs()}, "/rig", diagnostics);
  }
  BoundClip bind() {
    Diagnostics diagnostics;
    BoundClip clip = bind(diagnostics);
    diagnostics.throwIfErrors();
    return clip;
  }
  // Where the rig's joints are.
  std::array<Transform, kJoints> rigWorld(double time_s) const {
    std::array<Transform, kJoints> world;
    for (std::size_t j = 0; j < kJoints; ++j) {
      world[j] = sampleJoint(*motion, j, time_s);
      if (j > 0) world[j] = world[j - 1] * world[j];
    }
    return world;
  }
  PosedSkeleton pose(const BoundClip& clip, double time_s) const {
    Posture posture;
    samplePosture(clip, skeleton, time_s, posture);
    PosedSkeleton posed;
    skeleton.pose(posture, posed);
    return posed;
  }
};

double difference(const Transform& a, const Transform& b) {
  return (a.rotation - b.rotation).norm() + (a.translation_m - b.translation_m).norm();
}

TEST(BindSampled, MovesTheSkeletonAsTheRigThoughItsFramesStandOtherwise) {
  for (const bool loop : {false, true}) {
    Puppet puppet(loop);
    const BoundClip clip = puppet.bind();
    EXPECT_EQ(clip.name, "dance");
    EXPECT_EQ(clip.duration_s, puppet.motion->duration_s());
    double farthest = 0;
    for (int i = 0; i < 60; ++i) {
      const double time = -0.1 + 0.0137 * i;
      const auto rig = puppet.rigWorld(time);
      const PosedSkeleton posed = puppet.pose(clip, time);
      for (std::size_t j = 0; j < kJoints; ++j) {
        const Transform& now = posed.joint_world[j];
        EXPECT_LT(difference(now, rig[j] * puppet.change[j]), 1e-5) << kNames[j] << time;
        farthest = std::max(farthest, difference(now, puppet.rigRest[j] * puppet.change[j]));
      }
    }
    EXPECT_GT(farthest, 0.3);  // it moves at all
  }
}

TEST(BindSampled, HoldsWhatTheMotionTurnsPastNinetyDegrees) {
  Puppet puppet(true, kPi);
  const BoundClip clip = puppet.bind();
  for (int i = 0; i < 100; ++i) {
    const auto rig = puppet.rigWorld(0.005 * i);
    const PosedSkeleton posed = puppet.pose(clip, 0.005 * i);
    for (std::size_t j = 0; j < kJoints; ++j)
      EXPECT_LT(difference(posed.joint_world[j], rig[j] * puppet.change[j]), 1e-5) << i;
  }
}

TEST(BindSampled, SaysHowFastJointsMove) {
  Puppet puppet(true);
  const BoundClip clip = puppet.bind();
  constexpr double kStep_s = 1e-4;
  double fastest = 0;
  for (int frame = 0; frame < 10; ++frame) {
    // Half way between frames the motion is one cubic over the span that rates are measured in.
    const double time = (frame + 0.5) / puppet.motion->rate_hz;
    const PosedSkeleton before = puppet.pose(clip, time - kStep_s), now = puppet.pose(clip, time),
                        after = puppet.pose(clip, time + kStep_s);
    for (std::size_t j = 0; j < kJoints; ++j) {
      // A point that turns with the joint shows its whole twist.
      const Vec3 arm(0.3, -0.2, 0.4);
      const auto at = [&](const PosedSkeleton& p) { return p.joint_world[j].point(arm); };
      const Vec3 velocity = (at(after) - at(before)) / (2 * kStep_s);
      fastest = std::max(fastest, velocity.norm());
      EXPECT_LT((now.twist_world[j].at(at(now)) - velocity).norm(), 0.02 + 0.02 * velocity.norm())
          << kNames[j] << time;
    }
  }
  EXPECT_GT(fastest, 2);
}

TEST(BindSampled, RestsBeforeAndAfterAMotionThatDoesNotLoop) {
  Puppet puppet(false);
  const BoundClip clip = puppet.bind();
  for (const double time : {-0.5, 0.0, clip.duration_s, clip.duration_s + 3}) {
    Posture posture;
    samplePosture(clip, puppet.skeleton, time, posture);
    for (const double rate : posture.rates) EXPECT_EQ(rate, 0) << time;
  }
  Posture posture;
  samplePosture(clip, puppet.skeleton, 0.5 * clip.duration_s, posture);
  double fastest = 0;
  for (const double rate : posture.rates) fastest = std::max(fastest, std::abs(rate));
  EXPECT_GT(fastest, 0.1);
}

TEST(BindSampled, LeavesJointsThatTheMotionDoesNotNameAtRest) {
  Puppet puppet(true);
  puppet.skeletonDef.joints.push_back(
      {"ear", "hand", Vec3(0, 0.1, 0), Vec3::Zero(), {{Dof::rx, -1, 1, 0.25}}});
  const BoundClip clip = puppet.bind();
  Posture posture;
  samplePosture(clip, puppet.skeleton, 0.2, posture);
  ASSERT_EQ(posture.values.size(), 19u);
  EXPECT_EQ(posture.values[18], 0.25);
  EXPECT_EQ(posture.rates[18], 0);
}

void expectError(Puppet& puppet, const std::string& what) {
  Diagnostics diagnostics;
  puppet.bind(diagnostics);
  ASSERT_EQ(diagnostics.errors().size(), 1u);
  const Issue& issue = diagnostics.errors()[0];
  EXPECT_EQ(issue.where.pointer, "/rig");
  EXPECT_NE(issue.text().find(what), std::string::npos) << issue.text();
}

TEST(BindSampled, RefusesJointsThatCannotMoveEveryWay) {
  Puppet puppet(true);
  puppet.skeletonDef.joints[2].dofs.pop_back();
  expectError(puppet, "six degrees of freedom");
}

TEST(BindSampled, RefusesAJointThatHangsElsewhere) {
  Puppet puppet(true);
  puppet.skeletonDef.joints[2].parent = "root";
  expectError(puppet, "hangs from 'root'");
}

TEST(BindSampled, SuggestsTheNameOfAMissingJoint) {
  Puppet puppet(true);
  puppet.frames[2].name = "hnd";
  expectError(puppet, "hand");
}

}  // namespace
}  // namespace fascia
