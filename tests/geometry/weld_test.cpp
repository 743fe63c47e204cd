#include <fascia/geometry/weld.h>

#include <gtest/gtest.h>

#include <set>

namespace fascia {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;
using Points = std::vector<Eigen::Vector3f>;

const auto kAlways = [](std::uint32_t, std::uint32_t) { return true; };

// A square of two triangles in the plane z = 0, each triangle with its own three vertices.
const Points kLooseSquare = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const Triangles kLooseTriangles = {{0, 1, 2}, {3, 4, 5}};

TEST(Weld, JoinsTrianglesAlongTheirCommonEdge) {
  const Weld weld = weldVertices(kLooseSquare, kLooseTriangles, 1e-6f, kAlways);
  EXPECT_EQ(weld.pointCount, 4u);
  EXPECT_EQ(weld.point[0], weld.point[3]);
  EXPECT_EQ(weld.point[2], weld.point[4]);
  EXPECT_EQ(weld.point[1], 1u);
}

TEST(Weld, KeepsApartWhatIsNotAlike) {
  const auto never = [](std::uint32_t, std::uint32_t) { return false; };
  EXPECT_EQ(weldVertices(kLooseSquare, kLooseTriangles, 1e-6f, never).pointCount, 6u);
}

TEST(Weld, JoinsWithinTheToleranceAcrossCellsOnly) {
  for (const float shift : {0.f, 0.37f, 1.f, 1.63f, 2.f, 3.99f, 4.f}) {  // over the cells' borders
    Points points = kLooseSquare;
    for (Eigen::Vector3f& p : points) p.array() += shift * 1e-3f;
    for (std::size_t v = 3; v < 6; ++v) points[v].x() += 0.9e-3f;
    EXPECT_EQ(weldVertices(points, kLooseTriangles, 1e-3f, kAlways).pointCount, 4u);
    for (std::size_t v = 3; v < 6; ++v) points[v].x() += 0.3e-3f;
    EXPECT_EQ(weldVertices(points, kLooseTriangles, 1e-3f, kAlways).pointCount, 6u);
  }
}

// Two sheets at the same place, one seen from above and one from below, each of loose triangles.
TEST(Weld, NeverGluesSheetsFaceToFace) {
  Points points = kLooseSquare;
  points.insert(points.end(), kLooseSquare.begin(), kLooseSquare.end());
  Triangles triangles = kLooseTriangles;
  triangles.push_back({8, 7, 6});
  triangles.push_back({11, 10, 9});
  const Weld weld = weldVertices(points, triangles, 1e-6f, kAlways);
  EXPECT_EQ(weld.pointCount, 8u);  // four above, four below
  std::set<std::uint32_t> above, below;
  for (std::size_t v = 0; v < 6; ++v) above.insert(weld.point[v]);
  for (std::size_t v = 6; v < 12; ++v) below.insert(weld.point[v]);
  EXPECT_EQ(above.size(), 4u);
  for (const std::uint32_t p : below) EXPECT_EQ(above.count(p), 0u);
}

TEST(Weld, LeavesBodiesApartThatTouchInOnePoint) {
  const Points points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {-1, 0, 0}, {0, -1, 0}};
  EXPECT_EQ(weldVertices(points, kLooseTriangles, 1e-6f, kAlways).pointCount, 6u);
}

TEST(Weld, PrefersTheEvenContinuationWhereManySheetsMeet) {
  // Two flat strips cross in the edge from (0,0,0) to (0,1,0): one lies in z = 0, one in x = 0.
  const Points points = {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0},  //
                         {0, 1, 0}, {0, 0, 0}, {1, 0, 0},   //
                         {0, 0, 0}, {0, 1, 0}, {0, 0, -1},  //
                         {0, 1, 0}, {0, 0, 0}, {0, 0, 1}};
  const Triangles triangles = {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {9, 10, 11}};
  const Weld weld = weldVertices(points, triangles, 1e-6f, kAlways);
  EXPECT_EQ(weld.point[0], weld.point[4]);
  EXPECT_EQ(weld.point[6], weld.point[10]);
  EXPECT_NE(weld.point[0], weld.point[6]);
  EXPECT_EQ(weld.pointCount, 8u);
}

TEST(Weld, JoinsANeighbourWithTheWrongWinding) {
  Triangles triangles = kLooseTriangles;
  std::swap(triangles[1][0], triangles[1][1]);
  EXPECT_EQ(weldVertices(kLooseSquare, triangles, 1e-6f, kAlways).pointCount, 4u);
}

TEST(Weld, TakesManyTrianglesAtOneEdgeInItsStride) {
  Points points;
  Triangles triangles;
  for (std::uint32_t t = 0; t < 30000; ++t) {
    points.insert(points.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  EXPECT_EQ(weldVertices(points, triangles, 1e-6f, kAlways).pointCount, points.size());
  for (auto& t : triangles) t = {0, 1, 2};
  EXPECT_EQ(weldVertices(points, triangles, 1e-6f, kAlways).pointCount, 3u);  // the rest are loose
}

TEST(Components, AreNumberedByTheirFirstPoint) {
  std::vector<std::uint32_t> component;
  const Triangles triangles = {{5, 6, 4}, {0, 2, 3}, {3, 2, 7}};
  EXPECT_EQ(numberComponents(8, triangles, component), 3u);
  EXPECT_EQ(component, (std::vector<std::uint32_t>{0, 1, 0, 0, 2, 2, 2, 0}));
}

TEST(Degenerate, IsALineAndNotASliver) {
  const Eigen::Vector3f a(0, 0, 0), b(1, 0, 0);
  EXPECT_TRUE(isDegenerate(a, b, a));
  EXPECT_TRUE(isDegenerate(a, b, {0.3f, 0, 0}));
  EXPECT_TRUE(isDegenerate(a, b, {0.3f, 1e-7f, 0}));
  EXPECT_FALSE(isDegenerate(a, b, {0.3f, 1e-5f, 0}));
  EXPECT_FALSE(isDegenerate(1e-6f * a, 1e-6f * b, Eigen::Vector3f(0, 1e-6f, 0)));
}

}  // namespace
}  // namespace fascia
