#include <gtest/gtest.h>

#include <cmath>

#include <fascia/base/parallel.h>
#include <fascia/skin/joint_volume.h>

namespace fascia {
namespace {

constexpr int kAround = 24, kAlong = 41;
constexpr double kRadius_m = 0.1, kLength_m = 1;

// A closed tube along x around an elbow in its middle, whose points hang on the lower joint by a
// smooth step.
struct Arm {
  std::vector<JointCarrier::Joint> joints;
  std::vector<JointCarrier::Point> points;
  std::vector<JointVolume::Triangle> triangles;
  VectorArray rest;

  Arm() {
    joints = {{0, -1, Transform{}}, {1, 0, {Mat3::Identity(), Vec3(0.5 * kLength_m, 0, 0)}}};
    for (int i = 0; i < kAlong; ++i)
      for (int j = 0; j < kAround; ++j) {
        const double x = kLength_m * i / (kAlong - 1), a = 2 * kPi * j / kAround;
        add(Vec3(x, kRadius_m * std::cos(a), kRadius_m * std::sin(a)));
      }
    const auto at = [](int i, int j) {
      return static_cast<std::uint32_t>(i * kAround + j % kAround);
    };
    for (int i = 0; i + 1 < kAlong; ++i)
      for (int j = 0; j < kAround; ++j) {
        triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
        triangles.push_back({at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
      }
    for (const int end : {0, kAlong - 1}) {
      add(Vec3(kLength_m * end / (kAlong - 1), 0, 0));
      const auto middle = static_cast<std::uint32_t>(points.size() - 1);
      for (int j = 0; j < kAround; ++j) {
        const std::uint32_t a = at(end, j), b = at(end, j + 1);
        triangles.push_back(end == 0 ? JointVolume::Triangle{middle, b, a}
                                     : JointVolume::Triangle{middle, a, b});
      }
    }
    rest.resize(points.size());
    for (const JointCarrier::Point& p : points) put(rest, p.point, p.rest_world);
  }

  static void put(VectorArray& a, std::size_t k, const Vec3& p) {
    a.x[k] = static_cast<float>(p.x());
    a.y[k] = static_cast<float>(p.y());
    a.z[k] = static_cast<float>(p.z());
  }

  void add(const Vec3& p) {
    const double t = std::clamp((p.x() - 0.3) / 0.4, 0.0, 1.0);
    PointWeights w;
    w.joint[1] = 1;
    w.weight[1] = static_cast<float>(t * t * (3 - 2 * t));
    w.weight[0] = 1 - w.weight[1];
    points.push_back({points.size(), p, w});
  }

  JointVolume volume() const { return {joints, points, triangles, rest}; }

  // The elbow bent about z, its points by linear blending, which loses most.
  struct Bent {
    VectorArray place;
    std::vector<JointCarrier::Motion> motion;
  };
  Bent bent(double angle_rad) const {
    std::vector<Transform> pose{joints[0].rest_world, joints[1].rest_world};
    pose[1].rotation = Eigen::AngleAxisd(angle_rad, Vec3::UnitZ()).toRotationMatrix();
    Bent out{rest, {}};
    JointCarrier(joints, points).place(pose, out.motion, out.place);
    const Transform turn = pose[1] * joints[1].rest_world.inverse();
    for (const JointCarrier::Point& p : points) {
      const double share = double{p.weights.weight[1]};
      put(out.place, p.point, (1 - share) * p.rest_world + share * turn.point(p.rest_world));
    }
    return out;
  }

  double volume_m3(const VectorArray& place) const {
    const auto at = [&](std::size_t k) { return Vec3(place.x[k], place.y[k], place.z[k]); };
    double sixfold = 0;
    for (const JointVolume::Triangle& t : triangles)
      sixfold += at(t[0]).dot(at(t[1]).cross(at(t[2])));
    return sixfold / 6;
  }
};

VectorArray restored(const Arm& arm, const Arm::Bent& bent, float share = 1) {
  JointVolume::Scratch scratch;
  VectorArray place = bent.place;
  arm.volume().restore(share, bent.motion, scratch, place);
  return place;
}

double farthest(const VectorArray& a, const VectorArray& b, std::size_t first, std::size_t last) {
  double most = 0;
  for (std::size_t k = first; k < last; ++k)
    most = std::max<double>(most, std::hypot(a.x[k] - b.x[k], a.y[k] - b.y[k], a.z[k] - b.z[k]));
  return most;
}

TEST(JointVolume, GivesBackMostOfWhatABendTakes) {
  const Arm arm;
  const double whole = arm.volume_m3(arm.rest);
  for (const double angle_rad : {0.6, 1.0, 1.4}) {
    const Arm::Bent bent = arm.bent(angle_rad);
    const double lost = whole - arm.volume_m3(bent.place);
    const double left = whole - arm.volume_m3(restored(arm, bent));
    ASSERT_GT(lost, 0.005 * whole) << angle_rad;
    // Ways set in gently; what else is left is of second order in them.
    EXPECT_LT(std::abs(left), 0.3 * lost) << angle_rad;
  }
}

TEST(JointVolume, GivesBackTheShareAskedFor) {
  const Arm arm;
  const Arm::Bent bent = arm.bent(1.2);
  const double all = arm.volume_m3(restored(arm, bent)) - arm.volume_m3(bent.place);
  const double half = arm.volume_m3(restored(arm, bent, 0.5f)) - arm.volume_m3(bent.place);
  EXPECT_NEAR(half / all, 0.5, 0.1);
  EXPECT_EQ(farthest(restored(arm, bent, 0), bent.place, 0, arm.points.size()), 0);
}

TEST(JointVolume, LeavesTheRestShapeAndTheRestOfTheBodyAlone) {
  const Arm arm;
  EXPECT_LT(farthest(restored(arm, arm.bent(0)), arm.rest, 0, arm.points.size()), 1e-6);
  const Arm::Bent bent = arm.bent(1.2);
  const VectorArray now = restored(arm, bent);
  // Weights are 0 or 1 within 0.3 m of either end.
  EXPECT_EQ(farthest(now, bent.place, 0, 12 * kAround), 0);
  EXPECT_EQ(farthest(now, bent.place, 29 * kAround, arm.points.size()), 0);
  EXPECT_GT(farthest(now, bent.place, 12 * kAround, 29 * kAround), 1e-4);
}

TEST(JointVolume, LetsTheInnerSideOfAFoldBe) {
  const Arm arm;
  const Arm::Bent bent = arm.bent(kPi / 2);  // towards +y
  const VectorArray now = restored(arm, bent);
  const std::size_t ring = kAlong / 2 * kAround;
  EXPECT_LT(farthest(now, bent.place, ring, ring + 1),
            0.3 * farthest(now, bent.place, ring, ring + kAround));
}

TEST(JointVolume, NeverPushesFartherThanAShareOfTheLimb) {
  const Arm arm;
  Arm::Bent flat = arm.bent(0);
  for (float& y : flat.place.y) y *= 0.05f;  // a pose that no flesh survives
  EXPECT_LT(farthest(restored(arm, flat), flat.place, 0, arm.points.size()), 0.3 * kRadius_m);
}

TEST(JointVolume, HasTheSameBitsOnAnyNumberOfThreads) {
  const Arm arm;
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return restored(arm, arm.bent(1.3));
  };
  EXPECT_EQ(farthest(run(1), run(2), 0, arm.points.size()), 0);
}

}  // namespace
}  // namespace fascia
