#include <fascia/render/smooth_mesh.h>

#include <gtest/gtest.h>

#include "pictures.h"

namespace fascia {
namespace {

TEST(SmoothedMesh, OfACoarseSphereIsNearlyRound) {
  const TriangleMesh coarse = test::sphereMesh({0, 0, 0}, 1, 12);
  const TriangleMesh fine = smoothed(coarse, 4 * coarse.triangles.size());
  EXPECT_EQ(fine.triangles.size(), 4 * coarse.triangles.size());
  ASSERT_EQ(fine.normals.size(), fine.positions.size());
  // The flat diagonals, of up to 42°, dip 6.6 % below the sphere.
  for (const auto& p : fine.positions) EXPECT_NEAR(p.norm(), 1, 0.007f);
  for (std::size_t i = 0; i < fine.positions.size(); ++i)
    EXPECT_GT(fine.normals[i].dot(fine.positions[i].normalized()), 0.999f);
}

TEST(SmoothedMesh, LeavesAPlaneAndAFineMeshAlone) {
  TriangleMesh flat;
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.triangles = {{0, 1, 2}};
  flat.normals.assign(3, Eigen::Vector3f::UnitZ());
  flat.uvs = {{0, 0}, {1, 0}, {0, 1}};
  EXPECT_EQ(smoothed(flat, 1).positions, flat.positions);
  const TriangleMesh fine = smoothed(flat, 16);
  EXPECT_EQ(fine.triangles.size(), 16u);
  for (std::size_t i = 0; i < fine.positions.size(); ++i) {
    EXPECT_EQ(fine.positions[i].z(), 0);
    EXPECT_NEAR((fine.uvs[i] - fine.positions[i].head<2>()).norm(), 0, 1e-6f);
  }
}

}  // namespace
}  // namespace fascia
