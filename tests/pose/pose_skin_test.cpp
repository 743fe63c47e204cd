#include <gtest/gtest.h>

#include <cstring>

#include <fascia/base/parallel.h>
#include <fascia/measure/deformation.h>
#include <fascia/rig/linear_blend.h>

#include "limb.h"
#include "support/count_allocations.h"

namespace fascia {
namespace {

using test::Evaluation;
using test::farthest;
using test::Limb;
using test::posed;
using Points = std::vector<Eigen::Vector3f>;

Points linearlyBlended(const Limb& limb, std::span<const Transform> motion) {
  Points points;
  for (std::size_t i = 0; i < limb.points.size(); ++i) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < PointWeights::kMost; ++k)
      sum += double{limb.weights[i].weight[k]} *
             motion[limb.weights[i].joint[k]].point(limb.points[i].cast<double>());
    points.push_back(sum.cast<float>());
  }
  return points;
}

double volumeOf(const Limb& limb, const Points& points) {
  return surfaceVolume(limb.triangles, points).occupied_m3();
}

TEST(PoseSkin, IsExactInTheRestPose) {
  const Limb limb;
  EXPECT_LT(farthest(posed(limb.skin(), limb.turned(0)), limb.points), 1e-6f * 0.6f);
}

TEST(PoseSkin, MovesRigidlyWithARigidFigure) {
  const Limb limb;
  Transform all;
  all.rotation = Eigen::AngleAxisd(2, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  all.translation_m = Vec3(3, -1, 2);
  Points expected;
  for (const Eigen::Vector3f& p : limb.points)
    expected.push_back(all.point(p.cast<double>()).cast<float>());
  EXPECT_LT(farthest(posed(limb.skin(), limb.turned(0, Vec3::UnitZ(), all)), expected), 2e-6f);
}

// The shape of a bend does not depend on where in the world it happens.
TEST(PoseSkin, BendsAlikeFarAway) {
  const Limb limb;
  const PoseSkin skin = limb.skin();
  Transform away;
  away.translation_m = Vec3(1000, 0, 0);
  Points near = posed(skin, limb.turned(1.5)),
         far = posed(skin, limb.turned(1.5, Vec3::UnitZ(), away));
  for (Eigen::Vector3f& p : far) p -= Eigen::Vector3f(1000, 0, 0);
  EXPECT_LT(farthest(near, far), 1e-4f);  // the rounding of a float at a kilometre
  EXPECT_GT(farthest(near, limb.points), 0.1f);
}

TEST(PoseSkin, KeepsMoreVolumeThanLinearBlending) {
  const Limb limb;
  const double rest = volumeOf(limb, limb.points);
  for (const double angle : {kPi / 2, 2 * kPi / 3}) {
    const auto motion = limb.turned(angle);
    const double ours = rest - volumeOf(limb, posed(limb.skin(), motion));
    const double theirs = rest - volumeOf(limb, linearlyBlended(limb, motion));
    ASSERT_GT(theirs, 0.01 * rest) << angle;
    EXPECT_LT(std::abs(ours), 0.5 * theirs) << angle;
  }
}

TEST(PoseSkin, TwistsWithoutCollapsing) {
  const Limb limb;
  const auto motion = limb.turned(2.6, Vec3::UnitX());
  const double rest = volumeOf(limb, limb.points);
  const double theirs = rest - volumeOf(limb, linearlyBlended(limb, motion));
  ASSERT_GT(theirs, 0.05 * rest);
  EXPECT_LT(rest - volumeOf(limb, posed(limb.skin(), motion)), 0.6 * theirs);
}

TEST(PoseSkin, FoldsWithoutCrossingItself) {
  const Limb limb;
  const auto motion = limb.turned(2 * kPi / 3);
  const auto crossingsOf = [&](const Points& p) {
    return crossingTrianglePairs(limb.triangles, p);
  };
  EXPECT_GT(crossingsOf(linearlyBlended(limb, motion)), 20u);
  EXPECT_LE(crossingsOf(posed(limb.skin(), motion)), 3u);
}

TEST(PoseSkin, IsTheSameOnAnyNumberOfThreads) {
  const Limb limb(48, 120);
  const PoseSkin skin = limb.skin();
  const auto on = [&](int threads) {
    const ThreadLimit limit(threads);
    return posed(skin, limb.turned(2));
  };
  const Points one = on(1);
  for (const int threads : {2, 3}) {
    const Points many = on(threads);
    EXPECT_EQ(std::memcmp(one.data(), many.data(), one.size() * sizeof one[0]), 0) << threads;
  }
}

TEST(PoseSkin, BuiltTwiceIsTheSame) {
  const Limb limb;
  const auto motion = limb.turned(2);
  EXPECT_EQ(farthest(posed(limb.skin(), motion), posed(limb.skin(), motion)), 0);
}

TEST(PoseSkin, AllocatesNothingAfterTheFirstFrame) {
  const ThreadLimit one(1);
  const Limb limb;
  const PoseSkin skin = limb.skin();
  ASSERT_GT(skin.jiggle().nodeCount(), 0u);
  PoseSkin::Scratch scratch;
  VectorArray out(skin.pointCount());
  JiggleState jiggle;
  const auto straight = limb.turned(0.4), bent = limb.turned(2);
  for (int i = 0; i < 3; ++i) skin.evaluate(bent, {1.0 / 60, &jiggle, nullptr}, scratch, out);
  const long before = allocations;
  skin.evaluate(straight, {1.0 / 60, &jiggle, nullptr}, scratch, out);
  skin.evaluate(bent, {1.0 / 60, &jiggle, nullptr}, scratch, out);
  EXPECT_EQ(allocations - before, 0);
}

TEST(PoseSkin, LeavesRigidPiecesToTheirJoints) {
  const Limb limb;
  PoseDials dials;
  dials.rigid.assign(limb.points.size(), 1);
  const auto motion = limb.turned(1.2);
  const BasePose base(limb.source(), makePoseMesh(limb.source()));
  std::vector<JointMotion> joints;
  for (const Transform& t : motion) joints.push_back(jointMotion(t));
  FrameArray position(base.size()), turn(base.size());
  std::vector<WideRotation> rotation(base.size());
  base.place(joints, 0, base.size(), position, turn, rotation);
  const Points points = posed(limb.skin(dials), motion);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LT((points[i] - narrow(position[i])).norm(), 1e-6f) << i;
}

}  // namespace
}  // namespace fascia
