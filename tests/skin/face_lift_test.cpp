#include <set>

#include <gtest/gtest.h>

#include <fascia/base/parallel.h>
#include <fascia/skin/contact/face_depth.h>
#include <fascia/skin/contact/face_lift.h>

#include "test_fields.h"

namespace fascia {
namespace {

using test::RigidSolids;
using Faces = std::vector<std::array<std::uint32_t, 3>>;

// A coarse tube around a body that is curved more finely than its points lie.
struct CoarseTube {
  static constexpr double kFat_m = 0.01;
  GridLayout layout{9, 8, true};
  VectorArray position;
  PointModel points;
  Faces faces;

  explicit CoarseTube(double radius_m = 0.34, double height_m = 1) {
    position = test::tube(layout, radius_m, height_m);
    points.fat = test::constant(layout, kFat_m);
    points.free = test::constant(layout, 1);
    const auto at = [&](int i, int j) {
      return static_cast<std::uint32_t>(layout.at(layout.wrapped(i), j));
    };
    for (int j = 0; j + 1 < layout.rows; ++j)
      for (int i = 0; i < layout.columns; ++i) {
        faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  }
  std::unique_ptr<const FaceSamples> samples(const Field& field, double tolerance_m = 1e-3) const {
    return std::make_unique<FaceSamples>(sampleFaces(field, faces, position, kFat_m, tolerance_m));
  }
  TriangleMesh surface() const {
    TriangleMesh mesh;
    for (std::size_t k = 0; k < position.size(); ++k)
      mesh.positions.push_back(test::at(position, k).cast<float>());
    mesh.triangles = faces;
    return mesh;
  }
  void lift(const Field& field, const FaceSamples& samples) {
    liftFaces(samples, field, points, 1e-3f, kRestLift, position);
  }
  double deepest(const DistanceField& field) const { return deepestFace(field, surface()); }
};

// Its corners touch the fat around a cylinder of 0.33 m; the middle of an edge, 20° away, is
// 0.34 cos 20° from the axis.
RigidSolids thickPost() {
  SolidDef def;
  def.shape = "superellipsoid";
  def.parameters = {0.33, 0.33, 2, 0.1, 1};
  return RigidSolids().add(
      def, {Eigen::AngleAxisd(kPi / 2, Vec3::UnitX()).toRotationMatrix(), Vec3::Zero()});
}
constexpr double kSunk_m = 0.33 - 0.34 * 0.93969262;

TEST(FaceDepth, OfAFaceThroughASphereIsThatOfItsDeepestPlace) {
  Random random(5);
  for (int n = 0; n < 200; ++n) {
    const auto within = [&](double r) {
      return Vec3(random.uniform(-r, r), random.uniform(-r, r), random.uniform(-r, r));
    };
    const Vec3 center = within(1);
    const double radius = random.uniform(0.1, 0.6);
    const RigidSolids ball = RigidSolids().addSphere(center, radius);
    TriangleMesh mesh;
    for (int c = 0; c < 3; ++c) mesh.positions.push_back(within(1).cast<float>());
    mesh.triangles = {{0, 1, 2}};
    // By looking everywhere.
    double nearest = 1e300;
    for (int i = 0; i <= 200; ++i)
      for (int j = 0; i + j <= 200; ++j) {
        const float u = static_cast<float>(i) / 200, v = static_cast<float>(j) / 200;
        const Eigen::Vector3f p =
            (1 - u - v) * mesh.positions[0] + u * mesh.positions[1] + v * mesh.positions[2];
        nearest = std::min(nearest, (p.cast<double>() - center).norm());
      }
    EXPECT_NEAR(deepestFace(ball, mesh), std::max(0.0, radius - nearest), 5e-4) << n;
  }
}

TEST(FaceDepth, IsNothingForSurfacesThatAreEmptyOrAway) {
  const RigidSolids ball = RigidSolids().addSphere(Vec3::Zero(), 0.5);
  EXPECT_EQ(deepestFace(ball, TriangleMesh{}), 0);
  TriangleMesh mesh;
  mesh.positions = {{2, 0, 0}, {2, 1, 0}, {2, 0, 1}};
  mesh.triangles = {{0, 1, 2}};
  EXPECT_EQ(deepestFace(ball, mesh), 0);
}

TEST(FaceSamples, AreThereWhereFacesSinkIntoTheFat) {
  const CoarseTube tube;
  EXPECT_TRUE(tube.samples(RigidSolids().addSphere(Vec3::Zero(), 0.2))->empty());
  const auto few = tube.samples(thickPost(), 4e-3), many = tube.samples(thickPost(), 1e-3);
  EXPECT_FALSE(few->empty());
  // Half as far apart for a quarter of the tolerance.
  EXPECT_GT(many->samples.size(), 2.5 * static_cast<double>(few->samples.size()));
  EXPECT_LT(many->samples.size(), 5.5 * static_cast<double>(few->samples.size()));
}

TEST(FaceSamples, LieBetweenTheirCornersOnceEach) {
  const CoarseTube tube;
  const auto samples = tube.samples(thickPost());
  std::set<std::array<float, 3>> places;
  for (const FaceSamples::Sample& s : samples->samples) {
    EXPECT_NEAR(s.weights[0] + s.weights[1] + s.weights[2], 1, 1e-6);
    Eigen::Vector3f p = Eigen::Vector3f::Zero();
    for (int c = 0; c < 3; ++c) {
      EXPECT_GE(s.weights[c], 0);
      p += s.weights[c] * test::at(tube.position, s.corners[c]).cast<float>();
    }
    const auto rounded = [](float x) { return std::round(x * 1e5f); };
    EXPECT_TRUE(places.insert({rounded(p.x()), rounded(p.y()), rounded(p.z())}).second);
  }
}

TEST(FaceLift, BringsFacesOutOfTheFlesh) {
  const RigidSolids post = thickPost();
  CoarseTube tube;
  ASSERT_NEAR(tube.deepest(post), kSunk_m, 1e-3);
  tube.lift(post, *tube.samples(post));
  EXPECT_LT(tube.deepest(post), 1e-3);
  // Hardly farther than it must: what faces side by side push comes together a little.
  test::forEachPoint(tube.layout, [&](int, int, std::size_t k) {
    const Vec3 p = test::at(tube.position, k);
    EXPECT_LT(std::hypot(p.x(), p.z()), 0.331 / 0.9397 + 1e-2);
  });
}

TEST(FaceLift, StretchesNoEdgeFartherThanItMay) {
  // A ball far larger than the tube's cells sticks out of it: only spikes would cover it.
  const RigidSolids ball = RigidSolids().addSphere({0.34, 0, 0}, 0.3);
  CoarseTube tube;
  const auto samples = tube.samples(ball);
  ASSERT_FALSE(samples->empty());
  const auto longest = [&] {
    float most = 0;
    for (const FaceSamples::Edge& e : samples->edges) {
      const Vec3 along = test::at(tube.position, e.ends[1]) - test::at(tube.position, e.ends[0]);
      most = std::max(most, static_cast<float>(along.norm()) / e.rest_m);
    }
    return most;
  };
  EXPECT_NEAR(longest(), 1, 1e-5);
  const double deep_m = tube.deepest(ball);
  liftFaces(*samples, ball, tube.points, 1e-3f, 1.2, tube.position);
  EXPECT_GT(longest(), 1.15f);
  EXPECT_LT(longest(), 1.201f);
  EXPECT_LE(tube.deepest(ball), deep_m);
}

TEST(FaceLift, LeavesFixedPointsAndFacesThatAreOutside) {
  const RigidSolids post = thickPost();
  CoarseTube tube;
  tube.points.free = test::constant(tube.layout, 0);
  const VectorArray before = tube.position;
  tube.lift(post, *tube.samples(post));
  EXPECT_EQ(tube.position.x, before.x);

  CoarseTube wide;
  const auto samples = wide.samples(post);
  wide.position = test::tube(wide.layout, 0.5, 1);
  const VectorArray far = wide.position;
  wide.lift(post, *samples);
  EXPECT_EQ(wide.position.x, far.x);
}

// A skin that moves smoothly is seen to move smoothly.
TEST(FaceLift, ChangesSmoothlyWithTheFlesh) {
  const CoarseTube tube;
  RigidSolids post = thickPost();
  const auto samples = tube.samples(post);
  CoarseTube before;
  for (int step = 0; step <= 200; ++step) {
    post.parts[0].world.translation_m = Vec3(1e-4 * step, 0.5e-4 * step, 0);
    CoarseTube now = tube;
    now.lift(post, *samples);
    if (step > 0)
      test::forEachPoint(now.layout, [&](int, int, std::size_t k) {
        EXPECT_LT((test::at(now.position, k) - test::at(before.position, k)).norm(), 2e-3) << step;
      });
    before = now;
  }
}

TEST(FaceLift, GivesTheSameBitsOnAnyNumberOfThreads) {
  VectorArray found[2];
  for (int n = 0; n < 2; ++n) {
    const ThreadLimit limit(n == 0 ? 1 : 3);
    const RigidSolids post = thickPost();
    CoarseTube tube;
    tube.lift(post, *tube.samples(post));
    found[n] = tube.position;
  }
  for (const auto axis : VectorArray::kAxes) EXPECT_EQ(found[0].*axis, found[1].*axis);
}

}  // namespace
}  // namespace fascia
