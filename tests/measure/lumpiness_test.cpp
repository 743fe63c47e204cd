#include <gtest/gtest.h>

#include <numeric>

#include <Eigen/SVD>

#include <fascia/base/random.h>
#include <fascia/measure/best_rotation.h>
#include <fascia/measure/deformation.h>

#include "shapes.h"

namespace fascia {
namespace {

using Points = std::vector<Eigen::Vector3f>;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Mat3 someTurn(double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
}

Points moved(const Points& points, const Mat3& turn) {
  Points out;
  for (const Eigen::Vector3f& p : points)
    out.push_back((turn * p.cast<double>() + Vec3(0.3, -2, 1)).cast<float>());
  return out;
}

std::vector<std::uint32_t> all(std::size_t count) {
  std::vector<std::uint32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0u);
  return numbers;
}

TEST(BestRotation, IsThatOfTheSingularValueDecomposition) {
  Random random(5);
  for (int trial = 0; trial < 500; ++trial) {
    Mat3 m;
    for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = random.uniform(-1, 1);
    if (trial % 2 == 1) m.col(2) = m.col(0) * random.uniform(-1, 1);  // flat
    const Eigen::JacobiSVD<Mat3> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Vec3 s = svd.singularValues();
    Mat3 u = svd.matrixU();
    if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
    const Mat3 expected = u * svd.matrixV().transpose();
    const double sign = m.determinant() < 0 ? -1 : 1;
    if (s[1] + sign * s[2] < 1e-3) continue;  // several fit
    EXPECT_LT((bestRotation(m) - expected).norm(), 1e-6) << trial;
  }
}

TEST(BestRotation, IsARotationWhereNoneIsBetterThanAnother) {
  const Vec3 a(1, 2, 3), b(-2, 0.5, 1);
  for (const Mat3& m : {Mat3(Mat3::Zero()), Mat3(a * b.transpose()), Mat3(-Mat3::Identity())}) {
    const Mat3 r = bestRotation(m);
    EXPECT_NEAR(r.determinant(), 1, 1e-9);
    EXPECT_LT((r * r.transpose() - Mat3::Identity()).norm(), 1e-9);
  }
  EXPECT_LT((bestRotation(a * b.transpose()) * b.normalized() - a.normalized()).norm(), 1e-6);
}

TEST(Lumpiness, IsNothingForARigidMotion) {
  TriangleMesh mesh = tube(0.5, 2, 20, 30);
  const RestDetail detail(mesh.triangles, mesh.positions);
  const auto which = all(mesh.positions.size());
  for (const double angle_rad : {0.0, 0.8, 3.1}) {
    const Points now = moved(mesh.positions, someTurn(angle_rad));
    EXPECT_LT(lumpiness(detail, which, now).percentile99, 1e-4) << angle_rad;
  }
}

// A net of triangles in the plane z = 0.
TriangleMesh net(std::uint32_t side) {
  TriangleMesh mesh;
  for (std::uint32_t y = 0; y <= side; ++y)
    for (std::uint32_t x = 0; x <= side; ++x)
      mesh.positions.emplace_back(x + 0.5f * y, std::sqrt(0.75f) * y, 0.f);
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t p = y * (side + 1) + x, up = p + side + 1;
      mesh.triangles.push_back({p, p + 1, up});
      mesh.triangles.push_back({p + 1, up + 1, up});
    }
  return mesh;
}

TEST(Lumpiness, OfAPointLiftedOffANetIsItsHeightInEdges) {
  const TriangleMesh mesh = net(8);
  const RestDetail detail(mesh.triangles, mesh.positions);
  const std::uint32_t middle = 4 * 9 + 4;
  Points now = mesh.positions;
  now[middle].z() = 0.25f;  // edges are 1
  now = moved(now, someTurn(2));
  const std::uint32_t which[] = {middle};
  EXPECT_NEAR(lumpiness(detail, which, now).rms, 0.25, 1e-5);
  EXPECT_NEAR(lumpiness(detail, which, now).percentile99, 0.25, 1e-5);
}

// An icosahedron's corner lies r (1 − 1/√5) above its neighbours' mean, its edges are
// 2 r / √(φ √5) long; larger by s, the detail grows by s − 1 of that.
TEST(Lumpiness, OfAGrownIcosahedronIsItsDetailsGrowth) {
  const float g = 0.5f * (1 + std::sqrt(5.f));
  const Points rest = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                       {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  const Triangles triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                               {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                               {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                               {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  Points grown;
  for (const Eigen::Vector3f& p : rest) grown.push_back(1.3f * p);
  const double radius = std::sqrt(1 + static_cast<double>(g) * g);
  const double expected = 0.3 * radius * (1 - 1 / std::sqrt(5.0)) / 2;
  const RestDetail detail(triangles, rest);
  const Lumpiness l = lumpiness(detail, all(12), moved(grown, someTurn(1)));
  EXPECT_NEAR(l.rms, expected, 1e-5);
  EXPECT_NEAR(l.percentile99, expected, 1e-5);
}

TEST(Lumpiness, LeavesOpenEdgesOut) {
  const TriangleMesh mesh = net(2);  // one point inside
  const RestDetail detail(mesh.triangles, mesh.positions);
  for (std::uint32_t p = 0; p < 9; ++p) EXPECT_EQ(detail.has(p), p == 4) << p;
  Points now = mesh.positions;
  now[0].z() = 5;
  EXPECT_EQ(lumpiness(detail, all(1), now).rms, 0);
}

TEST(Lumpiness, IsInfiniteWherePointsAreNotNumbers) {
  const TriangleMesh mesh = net(4);
  const RestDetail detail(mesh.triangles, mesh.positions);
  Points now = mesh.positions;
  now[12].x() = std::nanf("");
  EXPECT_TRUE(std::isinf(lumpiness(detail, all(25), now).rms));
}

TEST(TurnedTriangles, AreNoneUnderAnyRigidMotion) {
  const TriangleMesh mesh = tube(0.5, 2, 20, 30);
  const Mat3 turn = someTurn(2.5);
  const std::vector<Eigen::Matrix3f> carried(mesh.positions.size(), turn.cast<float>());
  EXPECT_EQ(turnedTriangles(mesh.triangles, mesh.positions, carried, moved(mesh.positions, turn)),
            0u);
}

TEST(TurnedTriangles, AreThoseThatAPointFoldsOver) {
  const TriangleMesh mesh = net(4);
  const std::vector<Eigen::Matrix3f> carried(25, Eigen::Matrix3f::Identity());
  Points now = mesh.positions;
  // The middle point passes its right neighbour: the two triangles at that edge's far side turn.
  now[12].x() += 1.2f;
  EXPECT_EQ(turnedTriangles(mesh.triangles, mesh.positions, carried, now), 2u);
  // All of them, if the bones had not turned with it.
  const Mat3 over = Eigen::AngleAxisd(kPi, Vec3::UnitX()).toRotationMatrix();
  EXPECT_EQ(turnedTriangles(mesh.triangles, mesh.positions, carried, moved(mesh.positions, over)),
            mesh.triangles.size());
}

TEST(TurnedTriangles, CountTrianglesThatAreNoNumbers) {
  const TriangleMesh mesh = net(4);
  const std::vector<Eigen::Matrix3f> carried(25, Eigen::Matrix3f::Identity());
  Points now = mesh.positions;
  now[12].y() = std::nanf("");
  EXPECT_EQ(turnedTriangles(mesh.triangles, mesh.positions, carried, now), 6u);
}

}  // namespace
}  // namespace fascia
