#include <gtest/gtest.h>

#include <map>

#include <fascia/base/error.h>
#include <fascia/geometry/polygon.h>

namespace fascia {
namespace {

const std::vector<Vec2> kComb{{0, 0}, {5, 0}, {5, 3}, {4, 3}, {4, 1}, {3, 1},
                              {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};

double areaOf(std::span<const Vec2> p, const PlanarTriangles& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) {
    const double area = signedArea(std::vector<Vec2>{p[a], p[b], p[c]});
    EXPECT_GT(area, 0);
    sum += area;
  }
  return sum;
}

std::string refusal(const std::vector<Vec2>& polygon) {
  try {
    checkSimplePolygon(polygon);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(Polygon, AreaIsSignedByTheSenseOfItsCorners) {
  EXPECT_DOUBLE_EQ(signedArea(kComb), 11);
  EXPECT_DOUBLE_EQ(signedArea(std::vector<Vec2>(kComb.rbegin(), kComb.rend())), -11);
}

TEST(Polygon, TrianglesFillItExactly) {
  for (const auto& polygon : {kComb, std::vector<Vec2>(kComb.rbegin(), kComb.rend())}) {
    const PlanarTriangles triangles = triangulatePolygon(polygon);
    EXPECT_EQ(triangles.size(), polygon.size() - 2);
    EXPECT_NEAR(areaOf(polygon, triangles), 11, 1e-12);
  }
}

TEST(Polygon, CornersInStraightAnglesAreUsedToo) {
  const std::vector<Vec2> square{{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  std::vector<int> uses(square.size());
  const PlanarTriangles triangles = triangulatePolygon(square);
  for (const auto& t : triangles)
    for (const std::uint32_t corner : t) ++uses[corner];
  for (const int count : uses) EXPECT_GT(count, 0);
  EXPECT_NEAR(areaOf(square, triangles), 4, 1e-12);
}

TEST(Polygon, RefinedMeshFillsItWithShortEdgesAndNoGaps) {
  const PlanarMesh mesh = refined(kComb, triangulatePolygon(kComb), 0.4);
  EXPECT_NEAR(areaOf(mesh.positions_m, mesh.triangles), 11, 1e-9);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double border_m = 0;
  for (const auto& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c) ++edges[{t[c], t[(c + 1) % 3]}];
  for (const auto& [edge, count] : edges) {
    const double length_m = (mesh.positions_m[edge.first] - mesh.positions_m[edge.second]).norm();
    EXPECT_EQ(count, 1);
    EXPECT_LE(length_m, 0.4 + 1e-12);
    if (!edges.contains({edge.second, edge.first})) border_m += length_m;
  }
  EXPECT_NEAR(border_m, 24, 1e-9);  // the comb's own: an inner gap would add to it
}

TEST(Polygon, SaysWhatIsWrong) {
  EXPECT_EQ(refusal(kComb), "");
  EXPECT_NE(refusal({{0, 0}, {1, 0}}).find("2 corners"), std::string::npos);
  EXPECT_NE(refusal({{0, 0}, {2, 2}, {2, 0}, {0, 2}}).find("edges 0 and 2"), std::string::npos);
  EXPECT_NE(refusal({{0, 0}, {1, 0}, {1, 0}, {0, 1}}).find("edge 1"), std::string::npos);
  // Folded back onto itself, and a corner that touches an edge.
  EXPECT_NE(refusal({{0, 0}, {2, 0}, {1, 0}}).find("edges 0 and 1"), std::string::npos);
  EXPECT_NE(refusal({{0, 0}, {4, 0}, {4, 2}, {2, 0}, {0, 2}}).find("edges 0 and 2"),
            std::string::npos);
  EXPECT_NE(refusal({{0, 0}, {1, 0}, {0, std::nan("")}}).find("corner 2"), std::string::npos);
}

}  // namespace
}  // namespace fascia
