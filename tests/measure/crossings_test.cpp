#include <gtest/gtest.h>

#include <fascia/measure/deformation.h>

#include "shapes.h"

namespace fascia {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;
using Points = std::vector<Eigen::Vector3f>;

TEST(Crossings, FindATriangleThroughAnother) {
  const Points points = {{0, 0, 0},        {2, 0, 0},       {0, 2, 0},
                         {0.5f, 0.5f, -1}, {0.6f, 0.5f, 1}, {3, 3, 1}};
  const std::vector<CrossingPair> pairs = findCrossings(Triangles{{0, 1, 2}, {3, 4, 5}}, points);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0], (CrossingPair{0, 1}));
}

TEST(Crossings, AreSymmetricAndDoNotDependOnWinding) {
  const Points points = {{0, 0, 0},        {2, 0, 0},       {0, 2, 0},
                         {0.5f, 0.5f, -1}, {0.6f, 0.5f, 1}, {3, 3, 1}};
  EXPECT_EQ(crossingTrianglePairs(Triangles{{3, 4, 5}, {0, 1, 2}}, points), 1u);
  EXPECT_EQ(crossingTrianglePairs(Triangles{{0, 2, 1}, {5, 4, 3}}, points), 1u);
}

TEST(Crossings, AreNotTouchingNeighbouringOrCoplanarTriangles) {
  const Points points = {{0, 0, 0},       {2, 0, 0},       {0, 2, 0},
                         {0.5f, 0.5f, 0}, {0.5f, 0.5f, 1}, {0.9f, 0, 1},
                         {0.1f, 0.1f, 0}, {4, 0.1f, 0},    {0.1f, 4, 0}};
  EXPECT_EQ(crossingTrianglePairs(Triangles{{0, 1, 2}, {3, 4, 5}}, points), 0u)
      << "a tip on a face";
  EXPECT_EQ(crossingTrianglePairs(Triangles{{0, 1, 2}, {0, 1, 4}}, points), 0u) << "a shared edge";
  EXPECT_EQ(crossingTrianglePairs(Triangles{{0, 1, 2}, {6, 7, 8}}, points), 0u) << "one plane";
  const Points fold = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0.5f, 0.5f, -1}, {0.6f, 0.5f, 1}};
  EXPECT_EQ(crossingTrianglePairs(Triangles{{0, 1, 2}, {0, 3, 4}}, fold), 0u) << "a shared point";
}

TEST(Crossings, OfPlanesWhoseTrianglesAreApartAreNotCounted) {
  // Each has corners on both sides of the other's plane, but they lie side by side.
  const Points points = {{0, 0, 0},         {2, 0, 0},        {0, 2, 0},
                         {-0.2f, 0.5f, -1}, {-0.2f, 0.6f, 1}, {-5, 0.5f, 1}};
  for (const auto& first : Triangles{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}})
    EXPECT_EQ(crossingTrianglePairs(Triangles{first, {3, 4, 5}}, points), 0u) << first[0];
}

// Each facet of a tube of one ring is two triangles, and a plane across the tube cuts them all.
TEST(Crossings, CountsEveryTriangleOfATubeThatAPlaneCuts) {
  constexpr std::uint32_t kAround = 24;
  TriangleMesh mesh = tube(0.5, 1, kAround, 2);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {{0.4f, -9, -9}, {0.5f, 18, -9}, {0.6f, -9, 18}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  EXPECT_EQ(crossingTrianglePairs(mesh.triangles, mesh.positions), 2u * kAround);
}

TEST(Crossings, OfBoxesAppearWhenTheyAreMovedIntoEachOther) {
  TriangleMesh mesh;
  addBox(mesh, {0, 0, 0}, {1, 1, 1});
  addBox(mesh, {1.5, 0.13, 0.17}, {2.5, 1.12, 1.19});
  const std::vector<CrossingPair> apart = findCrossings(mesh.triangles, mesh.positions);
  EXPECT_TRUE(apart.empty());
  for (std::size_t p = 8; p < 16; ++p) mesh.positions[p].x() -= 0.7f;
  const std::vector<CrossingPair> together = findCrossings(mesh.triangles, mesh.positions);
  EXPECT_GT(together.size(), 4u);
  EXPECT_EQ(newCrossings(apart, together), together.size());
  EXPECT_EQ(newCrossings(together, together), 0u);
  EXPECT_EQ(newCrossings(together, apart), 0u);
}

TEST(Crossings, SkipsPointsThatAreNotNumbers) {
  const float nan = std::nanf("");
  const Points points = {{0, 0, 0},       {2, 0, 0},      {0, 2, 0},
                         {nan, 0.5f, -1}, {0.6f, nan, 1}, {3, 3, 1}};
  EXPECT_EQ(crossingTrianglePairs(Triangles{{0, 1, 2}, {3, 4, 5}}, points), 0u);
  EXPECT_EQ(crossingTrianglePairs({}, points), 0u);
}

}  // namespace
}  // namespace fascia
