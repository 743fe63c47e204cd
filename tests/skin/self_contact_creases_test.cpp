#include <gtest/gtest.h>

#include <fascia/skin/self_contact_creases.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fascia {
namespace {

constexpr double kElbow_m = 0.5;  // along x
constexpr double kRadius_m = 0.1;
constexpr double kRounding_m = 1e-5;

Vec3 at(const VectorArray& a, std::size_t k) {
  return {a.x[k], a.y[k], a.z[k]};
}
// An arm along x, bent about z at its elbow: a tube whose weights go over from the upper arm to the
// forearm within a radius around the elbow.
struct Arm {
  std::vector<JointCarrier::Joint> joints{{0, -1, {}},
                                          {1, 0, {Mat3::Identity(), Vec3(kElbow_m, 0, 0)}}};
  std::vector<JointCarrier::Point> points;
  CreaseModel model;
  VectorArray position;

  // toForearm(x): the forearm's share of a point.
  template <class Share>
  explicit Arm(const Share& toForearm) {
    for (int i = 0; i <= 60; ++i)
      for (int a = 0; a < 16; ++a) {
        const double x = i / 60.0, angle = 2 * kPi * a / 16;
        PointWeights w;
        w.joint = {0, 1};
        w.weight[1] = static_cast<float>(toForearm(x));
        w.weight[0] = 1 - w.weight[1];
        points.push_back(
            {points.size(), Vec3(x, kRadius_m * std::cos(angle), kRadius_m * std::sin(angle)), w});
      }
    model = prepareCreases(joints, points, points.size());
    position.resize(points.size());
  }
  Arm()
      : Arm([](double x) { return std::clamp(0.5 + 0.5 * (x - kElbow_m) / kRadius_m, 0.0, 1.0); }) {
  }

  static std::array<Transform, 2> bent(double angle) {
    const Mat3 turn = Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix();
    return {Transform{}, Transform{turn, Vec3(kElbow_m, 0, 0)}};
  }
  void carry(double angle) {
    std::vector<JointCarrier::Motion> scratch;
    JointCarrier(joints, points).place(bent(angle), scratch, position);
  }
  void meet(double angle) { meetInCreases(model, bent(angle), position); }
  // How far a member is on its own side of the plane that stands half-way between both limbs.
  double height(const CreaseModel::Member& m, double angle) const {
    const Vec3 normal(std::cos(angle / 2), std::sin(angle / 2), 0);
    return double{m.side} * normal.dot(at(position, m.point) - Vec3(kElbow_m, 0, 0));
  }
  // The farthest that any member near the elbow is on the wrong side.
  double deepest(double angle) const {
    double deepest = 0;
    for (const CreaseModel::Member& m : model.members)
      if (m.strength == 1) deepest = std::max(deepest, -height(m, angle));
    return deepest;
  }
};

TEST(Creases, LetBothLimbsMeetOnThePlaneHalfWayBetweenThem) {
  for (const double angle : {2.0, 2.4}) {
    Arm arm;
    ASSERT_EQ(arm.model.creases.size(), 1u);
    arm.carry(angle);
    ASSERT_GT(arm.deepest(angle), 0.1 * kRadius_m) << angle;
    for (int n = 0; n < 10; ++n) arm.meet(angle);
    EXPECT_LT(arm.deepest(angle), kRounding_m) << angle;
  }
}

TEST(Creases, LeaveTheOuterSideAlone) {
  constexpr double kAngle = 2;
  Arm arm;
  arm.carry(kAngle);
  const VectorArray before = arm.position;
  arm.meet(kAngle);
  std::size_t outer = 0;
  for (const CreaseModel::Member& m : arm.model.members) {
    if (arm.points[m.point].rest_world.y() > -0.5 * kRadius_m) continue;
    ++outer;
    EXPECT_NEAR((at(arm.position, m.point) - at(before, m.point)).norm(), 0, kRounding_m);
  }
  EXPECT_GT(outer, 20u);
}

TEST(Creases, ChangeNothingAtRestBeyondRounding) {
  Arm arm;
  arm.carry(0);
  const VectorArray before = arm.position;
  arm.meet(0);
  for (std::size_t k = 0; k < arm.points.size(); ++k)
    EXPECT_LT((at(arm.position, k) - at(before, k)).norm(), 1e-6) << k;
}

TEST(Creases, HaveNoPlaneWhereNonePartsTheLimbs) {
  // Every second ring belongs to the other limb.
  const Arm mixed([](double x) {
    return std::abs(x - kElbow_m) < 0.05 ? 0.5 : std::lround(60 * x) % 2 == 0 ? 1.0 : 0.0;
  });
  EXPECT_TRUE(mixed.model.creases.empty());
  EXPECT_TRUE(mixed.model.members.empty());
}

}  // namespace
}  // namespace fascia
