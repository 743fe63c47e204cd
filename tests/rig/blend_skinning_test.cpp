#include <gtest/gtest.h>

#include <memory>

#include <fascia/rig/delta_mush.h>
#include <fascia/rig/dual_quaternion.h>

#include "measure/shapes.h"

namespace fascia {
namespace {

using Points = std::vector<Eigen::Vector3f>;

constexpr std::uint32_t kAround = 16, kRings = 21;
constexpr double kRadius = 0.2, kLength = 2;

PointWeights share(float ofSecond) {
  PointWeights w;
  w.joint = {0, 1};
  w.weight = {1 - ofSecond, ofSecond};
  if (ofSecond > 0.5f) {
    std::swap(w.joint[0], w.joint[1]);
    std::swap(w.weight[0], w.weight[1]);
  }
  return w;
}

// A tube along x on two joints; the second sits in its middle. Weights change over along `blend_m`.
RiggedModel arm(double blend_m) {
  const TriangleMesh mesh = tube(kRadius, kLength, kAround, kRings);
  RiggedModel model;
  model.joints = {{"upper", -1, {}, -1}, {"lower", 0, {Mat3::Identity(), {1, 0, 0}}, -1}};
  model.points_m = mesh.positions;
  model.triangles = mesh.triangles;
  for (const Eigen::Vector3f& p : model.points_m) {
    const double x = static_cast<double>(p.x()) - 1;
    const double t = blend_m > 0 ? std::clamp(x / blend_m + 0.5, 0.0, 1.0) : x > 1e-6 ? 1.0 : 0.0;
    model.weights.push_back(share(static_cast<float>(t)));
  }
  return model;
}

std::vector<std::unique_ptr<BlendSkinning>> allMethods(const RiggedModel& model) {
  std::vector<std::unique_ptr<BlendSkinning>> methods;
  methods.push_back(std::make_unique<LinearBlend>(model));
  methods.push_back(std::make_unique<DualQuaternionBlend>(model));
  methods.push_back(std::make_unique<DeltaMush>(model));
  return methods;
}

// The second joint turned about an axis, seen from the bind pose.
std::vector<Transform> turned(const RiggedModel& model, double angle_rad, const Vec3& axis) {
  std::vector<Transform> world = {model.joints[0].rest_world, model.joints[1].rest_world}, motion;
  world[1].rotation = Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
  restToFrame(model, world, motion);
  return motion;
}

double largestDistance(const Points& a, const Points& b) {
  double largest = 0;
  for (std::size_t p = 0; p < a.size(); ++p)
    largest = std::max(largest, static_cast<double>((a[p] - b[p]).norm()));
  return largest;
}

TEST(BlendSkinning, MovesABodyRigidlyWhenAllJointsDo) {
  const RiggedModel model = arm(0.6);
  const Transform move{Eigen::AngleAxisd(2.2, Vec3(1, 3, -2).normalized()).toRotationMatrix(),
                       {0.4, -1, 2}};
  Points expected;
  for (const Eigen::Vector3f& p : model.points_m)
    expected.push_back(move.point(p.cast<double>()).cast<float>());
  for (const auto& method : allMethods(model)) {
    Points points(model.points_m.size());
    method->deform(std::vector<Transform>{move, move}, points);
    EXPECT_LT(largestDistance(points, expected), 3e-6) << method->name();
  }
}

TEST(BlendSkinning, GivesTheBindPoseBack) {
  const RiggedModel model = arm(0.6);
  for (const auto& method : allMethods(model)) {
    Points points(model.points_m.size());
    method->deform(turned(model, 0, Vec3::UnitX()), points);
    EXPECT_LT(largestDistance(points, model.points_m), 1e-6) << method->name();
  }
}

TEST(LinearBlend, CollapsesAHalfTurnAndDualQuaternionsDoNot) {
  const RiggedModel model = arm(0.6);
  const std::size_t middle = kRings / 2 * kAround;  // half and half
  const std::vector<Transform> twist = turned(model, kPi * 0.999, Vec3::UnitX());
  Points linear(model.points_m.size()), dual(model.points_m.size());
  LinearBlend(model).deform(twist, linear);
  DualQuaternionBlend(model).deform(twist, dual);
  EXPECT_LT(linear[middle].tail<2>().norm(), 0.01 * kRadius);
  for (const Eigen::Vector3f& p : dual) EXPECT_NEAR(p.tail<2>().norm(), kRadius, 1e-5);
}

TEST(DualQuaternionBlend, TurnsAPointHalfAndHalfByHalfTheAngle) {
  const RiggedModel model = arm(0.6);
  const std::size_t middle = kRings / 2 * kAround;
  // 250° is the turn by -110°: blending goes the shorter way round, whichever quaternion comes.
  for (const double angle_deg : {90.0, 170.0, 250.0}) {
    Points points(model.points_m.size());
    DualQuaternionBlend(model).deform(turned(model, radians(angle_deg), Vec3::UnitZ()), points);
    const double half = radians(angle_deg > 180 ? angle_deg - 360 : angle_deg) / 2;
    const Transform expected{Eigen::AngleAxisd(half, Vec3::UnitZ()).toRotationMatrix(),
                             Vec3::Zero()};
    const Vec3 lever = model.points_m[middle].cast<double>() - Vec3::UnitX();
    EXPECT_LT((points[middle].cast<double>() - Vec3::UnitX() - expected.vector(lever)).norm(),
              1e-6);
  }
}

// Weights that jump from one bone to the other tear the surface under linear blending; the mush
// spreads the bend over its smoothing.
TEST(DeltaMush, SpreadsABendThatWeightsConcentrate) {
  const RiggedModel model = arm(0);
  const std::vector<Transform> bend = turned(model, radians(90), Vec3::UnitZ());
  const auto longestEdge = [&model](const Points& points) {
    float longest = 0;
    for (const auto& t : model.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        longest = std::max(longest, (points[t[k]] - points[t[(k + 1) % 3]]).norm());
    return longest;
  };
  Points linear(model.points_m.size()), mush(model.points_m.size());
  LinearBlend(model).deform(bend, linear);
  DeltaMush(model).deform(bend, mush);
  EXPECT_LT(longestEdge(mush), 0.7f * longestEdge(linear));
  // Far from the bend nothing is lost of the shape: rings keep their radius.
  const std::size_t far = 2 * kAround;
  EXPECT_NEAR(mush[far].tail<2>().norm(), kRadius, 1e-3);
}

TEST(DeltaMush, LeavesOpenEdgesWhereTheyWere) {
  const RiggedModel model = arm(0.6);
  const std::vector<Transform> bend = turned(model, radians(70), Vec3::UnitY());
  Points linear(model.points_m.size()), mush(model.points_m.size());
  LinearBlend(model).deform(bend, linear);
  DeltaMush(model).deform(bend, mush);
  for (std::size_t p = 0; p < kAround; ++p) EXPECT_LT((linear[p] - mush[p]).norm(), 1e-6f);
}

TEST(PackedWeights, KeepsOnlyInfluencesThatCount) {
  std::vector<PointWeights> weights(2);
  weights[0].joint = {4, 2};
  weights[0].weight = {0.75f, 0.25f};
  weights[1].joint = {7};
  weights[1].weight = {1};
  const PackedWeights packed(weights);
  EXPECT_EQ(packed.first, (std::vector<std::uint32_t>{0, 2, 3}));
  EXPECT_EQ(packed.joint, (std::vector<std::uint32_t>{4, 2, 7}));
  EXPECT_EQ(packed.weight, (std::vector<float>{0.75f, 0.25f, 1}));
}

}  // namespace
}  // namespace fascia
