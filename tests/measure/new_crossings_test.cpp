#include <gtest/gtest.h>

#include <fascia/base/random.h>
#include <fascia/measure/deformation.h>

#include "shapes.h"

namespace fascia {
namespace {

using Points = std::vector<Eigen::Vector3f>;

// A tube, and the same again on other points.
TriangleMesh doubledTube() {
  TriangleMesh mesh = tube(0.1, 1, 24, 41);
  const TriangleMesh once = mesh;
  const auto count = static_cast<std::uint32_t>(once.positions.size());
  mesh.positions.insert(mesh.positions.end(), once.positions.begin(), once.positions.end());
  for (const auto& t : once.triangles)
    mesh.triangles.push_back({t[0] + count, t[1] + count, t[2] + count});
  return mesh;
}

// Bent by `angle_rad` into an arc about z from x = 0.4 on, over 0.2; with noise as rounding makes.
Points bent(const Points& points, double angle_rad, double noise_m) {
  Random random(3);
  Points out;
  for (const Eigen::Vector3f& f : points) {
    const Vec3 p = f.cast<double>();
    const double along = std::clamp(p.x() - 0.4, 0.0, 0.2), turn = angle_rad * along / 0.2;
    const double radius = 0.2 / angle_rad;
    const Vec3 on(0.4 + radius * std::sin(turn), radius * (1 - std::cos(turn)), 0);
    const Mat3 r = Eigen::AngleAxisd(turn, Vec3::UnitZ()).toRotationMatrix();
    const Vec3 rest(p.x() < 0.4 ? p.x() - 0.4 : std::max(0.0, p.x() - 0.6), p.y(), p.z());
    const Vec3 shake(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    out.push_back((on + r * rest + noise_m * shake).cast<float>());
  }
  return out;
}

std::size_t countNew(const TriangleMesh& mesh, const Points& now) {
  const double size_m = 1.02;  // of the tube's box
  return newCrossings(mesh.triangles, mesh.positions, findCrossings(mesh.triangles, mesh.positions),
                      now, kTouching * size_m)
      .size();
}

TEST(NewCrossings, AreNoneOfAShellDoubledOnItselfThatMovesOrBends) {
  const TriangleMesh mesh = doubledTube();
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (const double noise_m : {0.0, 1e-6, 3e-5}) {
    Points rigid;
    for (const Eigen::Vector3f& p : bent(mesh.positions, 1e-9, noise_m))
      rigid.push_back(turn.cast<float>() * p);
    EXPECT_EQ(countNew(mesh, rigid), 0u) << noise_m;
    for (const double angle_rad : {0.5, 1.2})
      EXPECT_EQ(countNew(mesh, bent(mesh.positions, angle_rad, noise_m)), 0u) << noise_m;
  }
  // Not for want of pairs that cross by rounding.
  EXPECT_GT(findCrossings(mesh.triangles, bent(mesh.positions, 1.2, 1e-6)).size(), 100u);
}

TEST(NewCrossings, OfShellsOnEachOtherCountWhereOneComesThrough) {
  const TriangleMesh mesh = doubledTube();
  // The second shell in waves, a hundredth of its radius in and out: 1 mm, ten times the tolerance.
  Points now = mesh.positions;
  for (std::size_t p = now.size() / 2; p < now.size(); ++p) {
    const float wave = 1 + 0.01f * std::sin(40 * now[p].x());
    now[p].y() *= wave;
    now[p].z() *= wave;
  }
  EXPECT_GT(countNew(mesh, now), 100u);
}

TEST(NewCrossings, OfFoldsCountAsEver) {
  // Once around a short arc: the inside of the bend passes through itself.
  const TriangleMesh once = tube(0.1, 1, 24, 41);
  const std::size_t folds = countNew(once, bent(once.positions, 2.6, 0));
  EXPECT_GT(folds, 10u);
  EXPECT_EQ(folds, crossingTrianglePairs(once.triangles, bent(once.positions, 2.6, 0)));
  const TriangleMesh twice = doubledTube();
  EXPECT_GE(countNew(twice, bent(twice.positions, 2.6, 0)), 2 * folds);
}

// Two triangles that touch within the tolerance at rest, upright on each other.
struct Cross {
  std::vector<std::array<std::uint32_t, 3>> triangles = {{0, 1, 2}, {3, 4, 5}};
  Points rest = {{-1, -1, 0},   {1, -1, 0},   {0, 1, 0},       // in the plane z = 0
                 {0, 0, 5e-5f}, {0.2f, 0, 1}, {-0.2f, 0, 1}};  // above it, a tip down
  std::size_t count(float sunk) const {
    Points now = rest;
    for (std::size_t p = 3; p < 6; ++p) now[p].z() -= sunk;
    return newCrossings(triangles, rest, {}, now, 1e-4).size();
  }
};

TEST(NewCrossings, OfWhatTouchesAtRestCountFromTheToleranceOn) {
  const Cross cross;
  EXPECT_EQ(cross.count(0), 0u);
  EXPECT_EQ(cross.count(1.4e-4f), 0u) << "9e-5 deep";
  EXPECT_EQ(cross.count(1.6e-4f), 1u) << "11e-5 deep";
  EXPECT_EQ(cross.count(0.5f), 1u);
}

TEST(NewCrossings, OfWhatIsApartAtRestCountAtOnce) {
  Cross cross;
  for (std::size_t p = 3; p < 6; ++p) cross.rest[p].z() += 2e-4f;
  EXPECT_EQ(cross.count(2e-4f), 0u);
  EXPECT_EQ(cross.count(2.6e-4f), 1u) << "1e-5 deep";
}

TEST(NewCrossings, LeaveThoseAtRestOut) {
  const Cross cross;
  Points sunk = cross.rest;
  for (std::size_t p = 3; p < 6; ++p) sunk[p].z() -= 0.5f;
  const auto atRest = findCrossings(cross.triangles, sunk);
  ASSERT_EQ(atRest.size(), 1u);
  EXPECT_TRUE(newCrossings(cross.triangles, sunk, atRest, sunk, 1e-4).empty());
}

}  // namespace
}  // namespace fascia
