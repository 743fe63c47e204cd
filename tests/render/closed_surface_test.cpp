#include <fascia/render/closed_surface.h>

#include <gtest/gtest.h>

#include <limits>

#include "pictures.h"

namespace fascia {
namespace {

TriangleMesh joined(TriangleMesh mesh, const TriangleMesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.triangles)
    mesh.triangles.push_back({first + a, first + b, first + c});
  return mesh;
}

TriangleMesh insideOut(TriangleMesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

// Its seam repeats vertices, and its poles have triangles without area.
const TriangleMesh& ball() {
  static const TriangleMesh mesh = test::sphereMesh({5, 6, 7}, 0.5f, 12);
  return mesh;
}

TEST(ClosedSurface, OfABallWithASeamFacesOutwards) {
  EXPECT_TRUE(facesOutwards(ball()));
  EXPECT_FALSE(facesOutwards(insideOut(ball())));
}

TEST(ClosedSurface, IsOpenWithoutOneTriangleOrWithOneTurned) {
  TriangleMesh holed = ball();
  holed.triangles.erase(holed.triangles.begin() + 60);
  EXPECT_FALSE(facesOutwards(holed));
  TriangleMesh turned = ball();
  std::swap(turned.triangles[60][0], turned.triangles[60][1]);
  EXPECT_FALSE(facesOutwards(turned));
}

TEST(ClosedSurface, OfSeveralPiecesNeedsAllOfThemToFaceOutwards) {
  const TriangleMesh other = test::sphereMesh({5.2f, 6, 7}, 0.6f, 10);
  EXPECT_TRUE(facesOutwards(joined(ball(), other)));
  EXPECT_FALSE(facesOutwards(joined(ball(), insideOut(other))));  // though it holds more in all
  EXPECT_FALSE(facesOutwards(joined(insideOut(ball()), other)));
}

TEST(ClosedSurface, IsNoneWhereThereIsNothingOrNoNumber) {
  EXPECT_FALSE(facesOutwards({}));
  TriangleMesh broken = ball();
  broken.positions[20].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(facesOutwards(broken));
}

}  // namespace
}  // namespace fascia
