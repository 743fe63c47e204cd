#include <fascia/pose/limb_press.h>

#include <cmath>

#include <gtest/gtest.h>

#include <fascia/base/parallel.h>
#include <fascia/pose/pose_mesh.h>

namespace fascia {
namespace {

using Eigen::Vector3f;

constexpr float kThigh_m = 0.08f, kRod_m = 0.02f, kApart_m = 0.06f;

// A thick limb along x, and above it, clear of it, another one along `axis`: each a closed tube on
// a bone of its own that moves as a whole.
struct TwoLimbs {
  std::vector<Vector3f> points;
  std::vector<PointWeights> weights;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<RigJoint> joints{{"root", -1, {}},
                               {"upper_leg", 0, {}},
                               {"lower_leg", 1, {}},
                               {"other", 0, {}},
                               {"other_end", 3, {}}};
  std::vector<float> softness;
  PoseMesh mesh;
  std::shared_ptr<const LimbParts> parts;
  LimbPress press;

  TwoLimbs(float otherRadius_m, const Vector3f& axis, float thighSoft, float otherSoft) {
    addTube(1, Vector3f::Zero(), Vector3f::UnitX(), kThigh_m, 0.5f, thighSoft);
    addTube(3, Vector3f(0, kThigh_m + otherRadius_m + kApart_m, 0), axis, otherRadius_m, 0.4f,
            otherSoft);
    const PoseSource source{points, weights, triangles, joints};
    mesh = makePoseMesh(source);
    parts = std::make_shared<const LimbParts>(makeLimbParts(source, mesh));
    press = LimbPress(source, mesh, parts, softness);
  }
  void addTube(std::uint16_t joint, const Vector3f& middle, const Vector3f& axis, float radius_m,
               float length_m, float soft) {
    const Vector3f across = axis.cross(Vector3f::UnitY()), up = across.cross(axis);
    const auto first = static_cast<std::uint32_t>(points.size());
    const int around = 32, along = 60;
    for (int i = 0; i <= along; ++i)
      for (int j = 0; j < around; ++j) {
        const float a = static_cast<float>(2 * kPi) * static_cast<float>(j) / around;
        const float t = static_cast<float>(i) / along - 0.5f;
        points.push_back(middle + t * length_m * axis +
                         radius_m * (std::cos(a) * across + std::sin(a) * up));
        weights.emplace_back();
        weights.back().joint[0] = joint;
        weights.back().weight[0] = 1;
        softness.push_back(soft);
      }
    const auto at = [&](int i, int j) {
      return first + static_cast<std::uint32_t>(i * around + j % around);
    };
    for (int i = 0; i < along; ++i)
      for (int j = 0; j < around; ++j) {
        triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
        triangles.push_back({at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
      }
    joints[joint].rest_world.translation_m = (middle - 0.5f * length_m * axis).cast<double>();
    joints[joint + 1u].rest_world.translation_m = (middle + 0.5f * length_m * axis).cast<double>();
  }
  bool isThigh(std::size_t i) const { return weights[i].joint[0] == 1; }

  // The other limb lowered so that it overlaps the thigh by so much; before and after.
  std::vector<Vector4f> carried(float depth_m) const {
    std::vector<Vector4f> position;
    for (std::size_t i = 0; i < points.size(); ++i)
      position.push_back(wide(points[i]) + (isThigh(i) ? Vector4f(0, 0, 0, 0)
                                                       : Vector4f(0, -depth_m - kApart_m, 0, 0)));
    return position;
  }
  std::vector<Vector4f> pressed(float depth_m) const {
    std::vector<JointMotion> motion(joints.size(), jointMotion({}));
    motion[3].shift = motion[4].shift = Vector4f(0, -depth_m - kApart_m, 0, 0);
    std::vector<Vector4f> position = carried(depth_m);
    LimbPress::Scratch scratch;
    press.press(motion, position, scratch);
    return position;
  }
  // How far the skin of one of the two sank, at most, away from its open ends.
  float sank(float depth_m, bool thigh) const {
    const std::vector<Vector4f> before = carried(depth_m), after = pressed(depth_m);
    float most = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (isThigh(i) == thigh && std::abs(points[i].x()) < 0.12f)
        most = std::max(most, (after[i] - before[i]).norm());
    return most;
  }
};

TEST(LimbPress, SoftSkinComesToLieBelowAHardLimb) {
  const TwoLimbs two(kRod_m, Vector3f::UnitZ(), 1, 0);
  const float depth = 0.012f;
  const std::vector<Vector4f> after = two.pressed(depth);
  const float axis_y = kThigh_m + kRod_m - depth;
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (!two.isThigh(i)) continue;
    const float fromAxis = std::hypot(after[i].x(), after[i].y() - axis_y);
    // What chords and points 7 mm apart cut off: (7 mm)² / 8 r.
    EXPECT_GT(fromAxis, kRod_m - 0.001f) << i;
  }
  EXPECT_GT(two.sank(depth, true), depth);
  EXPECT_EQ(two.sank(depth, false), 0);
}

TEST(LimbPress, LeavesTheFarSideAlone) {
  const TwoLimbs two(kRod_m, Vector3f::UnitZ(), 1, 0);
  const std::vector<Vector4f> before = two.carried(0.012f), after = two.pressed(0.012f);
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (two.points[i].y() > -0.03f && std::abs(two.points[i].x()) < 0.18f) continue;
    EXPECT_EQ((after[i] - before[i]).norm(), 0) << i;
  }
}

TEST(LimbPress, EquallySoftLimbsShareTheDepth) {
  const TwoLimbs two(kThigh_m, Vector3f::UnitX(), 0.8f, 0.8f);
  const float depth = 0.012f;
  EXPECT_NEAR(two.sank(depth, true), depth / 2, 0.15f * depth);
  EXPECT_NEAR(two.sank(depth, false), two.sank(depth, true), 0.15f * depth);
}

TEST(LimbPress, LimbsThatDoNotMeetStayAsTheyAre) {
  const TwoLimbs two(kRod_m, Vector3f::UnitZ(), 1, 0);
  EXPECT_GT(two.press.limbCount(), 0u);
  EXPECT_EQ(two.sank(-kApart_m, true), 0);  // as at rest
  EXPECT_EQ(two.sank(-0.01f, true), 0);
}

TEST(LimbPress, HardLimbsDoNotGiveWay) {
  EXPECT_EQ(TwoLimbs(kRod_m, Vector3f::UnitZ(), 0, 0).press.limbCount(), 0u);
}

TEST(LimbPress, LetsGoOfALimbThatIsDrivenDeep) {
  const TwoLimbs two(kRod_m, Vector3f::UnitZ(), 1, 0);
  EXPECT_GT(two.sank(0.03f, true), 0.01f);
  EXPECT_EQ(two.sank(kThigh_m, true), 0);
}

// Moved by half a millimetre a limb moves no skin by much more: contacts come and go smoothly.
TEST(LimbPress, ComesAndGoesWithoutJumps) {
  const TwoLimbs two(kRod_m, Vector3f::UnitZ(), 1, 0);
  const float step = 0.0005f;
  std::vector<Vector4f> last = two.pressed(-0.01f);
  for (float depth = -0.01f; depth < 0.09f; depth += step) {
    const std::vector<Vector4f> now = two.pressed(depth);
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (!two.isThigh(i)) continue;
      ASSERT_LT((now[i] - last[i]).norm(), 3 * step) << depth << " " << i;
    }
    last = now;
  }
}

TEST(LimbPress, SameBitsOnAnyNumberOfThreads) {
  const TwoLimbs two(0.5f * kThigh_m, Vector3f::UnitZ(), 1, 0.4f);
  std::vector<std::vector<Vector4f>> results;
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    results.push_back(two.pressed(0.015f));
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

}  // namespace
}  // namespace fascia
