#include <gtest/gtest.h>

#include <cmath>

#include <fascia/base/parallel.h>
#include <fascia/base/random.h>
#include <fascia/rig/linear_blend.h>
#include <fascia/skin/joint_carrier.h>

namespace fascia {
namespace {

constexpr double kElbow_m = 0.5;  // along x
constexpr double kRounding_m = 1e-6;

Transform turned(double angle_rad, const Vec3& axis, const Vec3& shift = Vec3::Zero()) {
  return {Eigen::AngleAxisd(angle_rad, axis.normalized()).toRotationMatrix(), shift};
}
// A turn about a point that stays.
Transform turnedAbout(const Vec3& center, double angle_rad, const Vec3& axis) {
  const Mat3 r = turned(angle_rad, axis).rotation;
  return {r, center - r * center};
}

PointWeights weights(std::initializer_list<std::pair<int, double>> given) {
  PointWeights w;
  std::size_t i = 0;
  for (const auto& [joint, weight] : given) {
    w.joint[i] = static_cast<std::uint16_t>(joint);
    w.weight[i++] = static_cast<float>(weight);
  }
  return w;
}

// Shoulder, elbow and wrist along x with frames that stand anyhow in them, and points to carry.
struct Carried {
  std::vector<JointCarrier::Joint> joints;
  std::vector<JointCarrier::Point> points;

  Carried() {
    joints = {{2, -1, turned(0.4, Vec3(1, 2, 3), Vec3::Zero())},
              {0, 0, turned(-1.3, Vec3(0, 2, 1), Vec3(kElbow_m, 0, 0))},
              {1, 1, turned(2.9, Vec3(1, 0, 1), Vec3(2 * kElbow_m, 0, 0))}};
  }
  void add(const Vec3& p, const PointWeights& w) { points.push_back({points.size(), p, w}); }

  // Joint frames in the order of the skeleton after each joint moved from rest to now.
  std::vector<Transform> pose(const std::array<Transform, 3>& motion) const {
    std::vector<Transform> out(3);
    for (std::size_t j = 0; j < 3; ++j)
      out[joints[j].skeletonJoint] = motion[j] * joints[j].rest_world;
    return out;
  }
  std::vector<Vec3> place(const std::array<Transform, 3>& motion) const {
    const JointCarrier carrier(joints, points);
    VectorArray out(points.size());
    std::vector<JointCarrier::Motion> scratch;
    carrier.place(pose(motion), scratch, out);
    std::vector<Vec3> places;
    for (std::size_t k = 0; k < points.size(); ++k)
      places.emplace_back(out.x[k], out.y[k], out.z[k]);
    return places;
  }
  // By linear blend skinning.
  std::vector<Vec3> blended(const std::array<Transform, 3>& motion) const {
    RiggedModel model;
    for (const JointCarrier::Joint& j : joints)
      model.joints.push_back({"", j.parent, j.rest_world, -1});
    for (const JointCarrier::Point& p : points) {
      model.points_m.push_back(p.rest_world.cast<float>());
      model.weights.push_back(p.weights);
    }
    std::vector<Eigen::Vector3f> out(points.size());
    LinearBlend(model).deform(motion, out);
    std::vector<Vec3> places;
    for (const Eigen::Vector3f& p : out) places.push_back(p.cast<double>());
    return places;
  }
};

// Points all over the arm with all kinds of weights.
Carried scattered(int count) {
  Carried c;
  Random random(7);
  for (int i = 0; i < count; ++i) {
    const double a = random.uniform(0, 1), b = random.uniform(0, 1 - a);
    const Vec3 p(random.uniform(-0.2, 1.2), random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2));
    switch (i % 3) {
      case 0:
        c.add(p, weights({{i / 3 % 3, 1}}));
        break;
      case 1:
        c.add(p, weights({{1, a}, {0, 1 - a}}));
        break;
      default:
        c.add(p, weights({{2, a}, {0, b}, {1, 1 - a - b}}));
    }
  }
  return c;
}

TEST(JointCarrier, LeavesPointsAtRestWhereTheyAre) {
  const Carried c = scattered(300);
  const std::vector<Vec3> places = c.place({});
  for (std::size_t k = 0; k < places.size(); ++k)
    EXPECT_LT((places[k] - c.points[k].rest_world).norm(), kRounding_m) << k;
}

TEST(JointCarrier, CarriesPointsExactlyWhenAllJointsMoveAsOne) {
  const Carried c = scattered(300);
  const Transform move = turned(2.2, Vec3(-1, 0.3, 0.8), Vec3(1, -2, 0.5));
  const std::vector<Vec3> places = c.place({move, move, move});
  for (std::size_t k = 0; k < places.size(); ++k)
    EXPECT_LT((places[k] - move.point(c.points[k].rest_world)).norm(), 4 * kRounding_m) << k;
}

TEST(JointCarrier, MovesPointsOfASingleJointRigidlyWithIt) {
  const Carried c = scattered(300);
  const std::array<Transform, 3> motion{turned(0.3, Vec3(1, 1, 0), Vec3(0, 1, 0)),
                                        turned(-2.5, Vec3(0, 1, 3), Vec3(1, 0, 0)),
                                        turned(1.7, Vec3(2, 1, 0), Vec3(0, 0, 4))};
  const std::vector<Vec3> places = c.place(motion);
  std::size_t single = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const PointWeights& w = c.points[k].weights;
    if (w.weight[0] < 1) continue;
    ++single;
    const Vec3 expected = motion[w.joint[0]].point(c.points[k].rest_world);
    EXPECT_LT((places[k] - expected).norm(), 4 * kRounding_m) << k;
  }
  EXPECT_EQ(single, 100u);
}

// A ring of points around the elbow that belong to both bones alike.
Carried elbowRing(double radius_m) {
  Carried c;
  for (int i = 0; i < 24; ++i) {
    const double a = 2 * kPi * i / 24;
    c.add(Vec3(kElbow_m, radius_m * std::cos(a), radius_m * std::sin(a)),
          weights({{0, 0.5}, {1, 0.5}}));
  }
  return c;
}
std::array<Transform, 3> bentElbow(double angle_rad, const Vec3& axis) {
  const Transform bend = turnedAbout(Vec3(kElbow_m, 0, 0), angle_rad, axis);
  return {Transform(), bend, bend};
}

TEST(JointCarrier, KeepsTheRadiusOfABendingJointWhereLinearBlendLosesIt) {
  constexpr double kRadius_m = 0.1;
  const Carried c = elbowRing(kRadius_m);
  const Vec3 elbow(kElbow_m, 0, 0);
  const std::array<Transform, 3> motion = bentElbow(kPi / 2, Vec3::UnitZ());
  const std::vector<Vec3> places = c.place(motion), blended = c.blended(motion);
  for (std::size_t k = 0; k < places.size(); ++k) {
    EXPECT_NEAR((places[k] - elbow).norm(), kRadius_m, kRounding_m) << k;
    // The mean of two turns 90° apart shrinks what is perpendicular to the axis by cos 45°.
    const Vec3 arm = c.points[k].rest_world - elbow;
    const double shrunk = std::hypot(arm.y() * std::cos(kPi / 4), arm.z());
    EXPECT_NEAR((blended[k] - elbow).norm(), shrunk, kRounding_m) << k;
  }
  EXPECT_NEAR((blended[0] - elbow).norm(), 0.1 * std::sqrt(0.5), kRounding_m);
}

TEST(JointCarrier, KeepsATwistedWristOpenWhereLinearBlendShutsIt) {
  const Carried c = elbowRing(0.05);
  const Vec3 elbow(kElbow_m, 0, 0);
  const std::array<Transform, 3> motion = bentElbow(0.999 * kPi, Vec3::UnitX());
  const std::vector<Vec3> places = c.place(motion), blended = c.blended(motion);
  for (std::size_t k = 0; k < places.size(); ++k) {
    EXPECT_NEAR((places[k] - elbow).norm(), 0.05, kRounding_m) << k;
    EXPECT_LT((blended[k] - elbow).norm(), 1e-3) << k;
  }
}

TEST(JointCarrier, TurnsAPointOfTwoBonesByTheShareOfEach) {
  for (const double share : {0.25, 0.5, 0.75}) {
    Carried c;
    c.add(Vec3(kElbow_m, 0.1, 0), weights({{0, 1 - share}, {1, share}}));
    const Vec3 place = c.place(bentElbow(0.4, Vec3::UnitZ()))[0] - Vec3(kElbow_m, 0, 0);
    const double angle = std::atan2(-place.x(), place.y());
    EXPECT_NEAR(angle, 0.4 * share, 1e-3) << share;
    EXPECT_NEAR(place.norm(), 0.1, kRounding_m);
  }
}

TEST(JointCarrier, TakesQuaternionsOfOppositeSignForTheSameTurn) {
  // Frames of which one turns past 180°: their quaternions lie in different hemispheres.
  const Vec3 elbow(kElbow_m, 0, 0);
  Carried c = elbowRing(0.1);
  for (int i = 0; i < 48; ++i) {
    const double base = 2 * kPi * i / 48;
    std::array<Transform, 3> motion = bentElbow(0.5, Vec3::UnitZ());
    const Transform whole = turnedAbout(elbow, base, Vec3(0.2, -0.3, 1));
    for (Transform& m : motion) m = whole * m;
    const std::vector<Vec3> places = c.place(motion);
    const std::vector<Vec3> still = c.place(bentElbow(0.5, Vec3::UnitZ()));
    for (std::size_t k = 0; k < places.size(); ++k)
      EXPECT_LT((places[k] - whole.point(still[k])).norm(), 4 * kRounding_m) << base;
  }
}

TEST(JointCarrier, BlendsDistantBonesAboutTheJointsBetweenThem) {
  // Shoulder's and wrist's: the chain between them bends at elbow and wrist, which lie at 0.5
  // and 1.
  Carried c;
  c.add(Vec3(0.75, 0.1, 0), weights({{0, 0.5}, {2, 0.5}}));
  const Vec3 center(0.75, 0, 0);
  const Transform bend = turnedAbout(center, kPi / 2, Vec3::UnitZ());
  const Vec3 place = c.place({Transform(), bend, bend})[0];
  EXPECT_NEAR((place - center).norm(), 0.1, kRounding_m);
}

TEST(JointCarrier, LeavesEntriesOfOtherPointsAlone) {
  Carried c;
  c.points = {{3, Vec3(0.2, 0, 0), weights({{0, 1}})}, {1, Vec3(0.7, 0, 0), weights({{1, 1}})}};
  const JointCarrier carrier(c.joints, c.points);
  ASSERT_EQ(carrier.pointCount(), 2u);
  VectorArray out(5);
  out.fill(-7);
  std::vector<JointCarrier::Motion> scratch;
  carrier.place(c.pose({}), scratch, out);
  for (const std::size_t k : {0u, 2u, 4u}) EXPECT_EQ(out.x[k], -7);
  EXPECT_NEAR(out.x[3], 0.2, kRounding_m);
  EXPECT_NEAR(out.x[1], 0.7, kRounding_m);
}

TEST(JointCarrier, SharesOutTheWeightsOfInfluencesThatItDrops) {
  Carried c;
  c.add(Vec3(0.3, 0, 0), weights({{0, 0.99995}, {2, 0.00005}}));
  const Transform away = turned(0, Vec3::UnitX(), Vec3(0, 1000, 0));
  EXPECT_LT((c.place({Transform(), Transform(), away})[0] - Vec3(0.3, 0, 0)).norm(), kRounding_m);
}

TEST(JointCarrier, PlacesTheSameBitsOnAnyNumberOfThreads) {
  const Carried c = scattered(9000);
  const std::array<Transform, 3> motion = bentElbow(1.1, Vec3(1, 2, 3));
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return c.place(motion);
  };
  EXPECT_EQ(run(1), run(2));
}

}  // namespace
}  // namespace fascia
