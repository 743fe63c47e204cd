#include <gtest/gtest.h>

#include <fascia/deformable/body/carried_mesh.h>
#include <fascia/field/solid.h>
#include <fascia/geometry/welded_normals.h>

#include "bodies.h"

namespace fascia {
namespace {

TriangleMesh sphereMesh(double radius_m, int detail) {
  Diagnostics diagnostics;
  return Solid({"sphere", {radius_m}, {}}, "", diagnostics).tessellate(detail);
}

// A sphere under an affine map is an ellipsoid, whose normal at x is A⁻ᵀ A⁻¹ x.
TEST(CarriedMesh, OfASphereUnderAnAffineMapIsAnEllipsoidWithItsNormals) {
  const auto shape = test::makeBar(makeAffineBasis(3));
  const TriangleMesh sphere = sphereMesh(0.05, 24);
  const CarriedMesh carried(*shape, sphere);
  const Eigen::VectorXd q = test::deformed(*shape, 0.2, 3);
  const Mat3 F = shape->deformationGradient(test::view(q), Vec3::Zero());
  const Vec3 center = shape->point(test::view(q), Vec3::Zero());
  TriangleMesh mesh;
  carried.carry(test::view(q), mesh);
  ASSERT_EQ(mesh.positions.size(), sphere.positions.size());
  EXPECT_EQ(mesh.triangles, sphere.triangles);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3 X = F.inverse() * (mesh.positions[i].cast<double>() - center);
    EXPECT_NEAR(X.norm(), 0.05, 1e-6);
    const Vec3 normal = (F.inverse().transpose() * X).normalized();
    EXPECT_NEAR((mesh.normals[i].cast<double>() - normal).norm(), 0, 2e-2);  // of a facetted sphere
  }
}

// Normals by cofactors agree with those of the deformed triangles, more so the finer these are.
TEST(CarriedMesh, NormalsOfABentBodyAreThoseOfItsTriangles) {
  const auto shape = test::makeBar(makePolynomialBasis(3, 2, test::boxOf(test::kBarSize_m)));
  const Eigen::VectorXd q = test::deformed(*shape, 0.02, 5);
  double coarser = 1;
  for (const int detail : {16, 32, 64}) {
    TriangleMesh sphere = sphereMesh(0.05, detail);
    WeldedNormals(sphere).compute(sphere.positions, sphere.normals);
    TriangleMesh mesh;
    CarriedMesh(*shape, sphere).carry(test::view(q), mesh);
    std::vector<Eigen::Vector3f> expected;
    WeldedNormals(sphere).compute(mesh.positions, expected);
    double worst = 0;
    for (std::size_t i = 0; i < expected.size(); ++i)
      worst = std::max(worst, static_cast<double>((expected[i] - mesh.normals[i]).norm()));
    EXPECT_LT(worst, 0.7 * coarser);
    coarser = worst;
  }
  EXPECT_LT(coarser, 0.05);
}

TEST(CarriedMesh, KeepsItsDepthInTwoDimensions) {
  const auto shape = test::makeBar(makeAffineBasis(2));
  const TriangleMesh sphere = sphereMesh(0.05, 12);
  TriangleMesh mesh;
  const Eigen::VectorXd q = test::deformed(*shape, 0.2, 7);
  CarriedMesh(*shape, sphere).carry(test::view(q), mesh);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    EXPECT_EQ(mesh.positions[i].z(), sphere.positions[i].z());
    const Vec3 x = shape->point(test::view(q), sphere.positions[i].cast<double>());
    EXPECT_NEAR((mesh.positions[i].cast<double>() - x).head(2).norm(), 0, 1e-6);
  }
}

}  // namespace
}  // namespace fascia
