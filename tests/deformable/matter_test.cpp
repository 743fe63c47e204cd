#include <gtest/gtest.h>

#include <fascia/base/error.h>

#include "bodies.h"

namespace fascia {
namespace {

// ∫ x^i y^j z^k over a box around the origin: products of 2 (h^(n+1))/(n+1) for even powers.
double boxMoment(const Vec3& size, const Eigen::Vector3i& power) {
  double product = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const int n = power[axis];
    product *= n % 2 == 1 ? 0 : 2 * std::pow(0.5 * size[axis], n + 1) / (n + 1);
  }
  return product;
}

double moment(const Quadrature& rule, const Eigen::Vector3i& power) {
  double sum = 0;
  for (std::size_t i = 0; i < rule.size(); ++i) {
    const Vec3& X = rule.points_m[i];
    sum += rule.weights[i] * std::pow(X.x(), power.x()) * std::pow(X.y(), power.y()) *
           std::pow(X.z(), power.z());
  }
  return sum;
}

TriangleMesh boxMesh(const Vec3& size) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner((i & 1) - 0.5, ((i >> 1) & 1) - 0.5, ((i >> 2) & 1) - 0.5);
    mesh.positions.push_back(corner.cwiseProduct(size).cast<float>());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

const Vec3 kSize_m{0.5, 0.25, 1};  // exact in single precision, as meshes are

void expectMoments(const Quadrature& rule, int degree, double tolerance) {
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j)
      for (int k = 0; i + j + k <= degree; ++k)
        EXPECT_NEAR(moment(rule, {i, j, k}), boxMoment(kSize_m, {i, j, k}), tolerance)
            << i << j << k;
}

TEST(Quadrature, BoxesAreExactUpToTheirDegree) {
  expectMoments(boxQuadrature(3, test::boxOf(kSize_m), 7), 7, 1e-15);
}

TEST(Quadrature, ClosedMeshesAreExactUpToTheirDegree) {
  expectMoments(closedMeshQuadrature(boxMesh(kSize_m), 6), 6, 1e-15);
}

TEST(Quadrature, IsNoMoreExactThanItsDegree) {
  const double exact = boxMoment(kSize_m, {0, 0, 8});
  EXPECT_GT(std::abs(moment(boxQuadrature(3, test::boxOf(kSize_m), 7), {0, 0, 8}) - exact),
            1e-3 * exact);
}

TEST(Quadrature, ReductionKeepsMomentsWithFewPositivePoints) {
  const Quadrature fine = sampledMeshQuadrature(boxMesh(kSize_m), 0.03, 4);
  const Quadrature few = reducedQuadrature(fine, 3, 4);
  EXPECT_GT(fine.size(), 500u);
  EXPECT_LE(few.size(), 35u);
  EXPECT_GT(*std::ranges::min_element(few.weights), 0);
  for (const Eigen::Vector3i& power :
       {Eigen::Vector3i{0, 0, 0}, {1, 1, 0}, {0, 0, 4}, {2, 1, 1}, {0, 2, 2}})
    EXPECT_NEAR(moment(few, power), moment(fine, power), 1e-13);
}

TEST(Matter, OfABallHasItsInertia) {
  Diagnostics diagnostics;
  const Solid ball(SolidDef{"sphere", {0.3}, {}}, "", diagnostics);
  const double volume = 4.0 / 3 * kPi * 0.027, inertia = volume * 0.09 / 5;  // ∫ x² = V r²/5
  double lastError = 0;
  for (const double cell_m : {0.06, 0.03}) {
    const Matter matter = solidMatter(ball, 1, cell_m, MatterDetail::of(1));
    const double error = std::abs(moment(matter.mass, {2, 0, 0}) / inertia - 1);
    EXPECT_LT(error, 40 * cell_m * cell_m);
    EXPECT_NEAR(matter.volume.total(), volume, 0.05 * volume);
    EXPECT_TRUE(lastError == 0 || error < 0.5 * lastError);
    lastError = error;
  }
}

TEST(Matter, OfAMeshAndOfTheSameBoxMakeTheSameBody) {
  const BasisPtr basis = makePolynomialBasis(3, 2, test::boxOf(kSize_m));
  const MatterDetail detail = MatterDetail::of(*basis);
  const BodyShape box({basis, boxMatter(3, test::boxOf(kSize_m), 500, detail), {}});
  const BodyShape mesh({basis, meshMatter(boxMesh(kSize_m), 500, 0.02, detail), {}});
  EXPECT_NEAR(mesh.mass_kg(), box.mass_kg(), 1e-12);
  EXPECT_NEAR(mesh.volume_m3(), box.volume_m3(), 1e-12);
  const Vec3 X(0.1, -0.05, 0.3);
  EXPECT_LT((mesh.pointWeights(X) - box.pointWeights(X)).norm(), 1e-10);
  const Eigen::VectorXd q = test::deformed(box, 0.002, 3);
  EXPECT_NEAR(mesh.energy(test::view(q)), box.energy(test::view(q)),
              0.02 * box.energy(test::view(q)));
}

TEST(Matter, RefusesWhatHasNoMass) {
  EXPECT_THROW(boxMatter(3, test::boxOf(Vec3::Ones()), -1, MatterDetail::of(1)), Error);
  EXPECT_THROW(boxMatter(3, test::boxOf({1, 0, 1}), 1, MatterDetail::of(1)), Error);
  EXPECT_THROW(pointMatter({}, {}, 1), Error);
  TriangleMesh inside = boxMesh(kSize_m);
  for (auto& triangle : inside.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_THROW(meshMatter(inside, 1, 0.1, MatterDetail::of(1)), Error);
}

TEST(Matter, OutlinesMassIsExactAndTheirEnergyPointsLieInside) {
  // An L: the square [0, 2]² without [1, 2]²; its integrals are differences of the squares'.
  const std::vector<Vec2> corners{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  const auto powers = [](double low, double high, int n) {
    return (std::pow(high, n + 1) - std::pow(low, n + 1)) / (n + 1);
  };
  for (const auto& outline : {corners, std::vector<Vec2>(corners.rbegin(), corners.rend())}) {
    const Matter matter = outlineMatter(outline, 3, {6, 4, {{1, 1, 0}, 1}});
    for (int i = 0; i <= 6; ++i) {
      for (int j = 0; i + j <= 6; ++j) {
        const double exact = powers(0, 2, i) * powers(0, 2, j) - powers(1, 2, i) * powers(1, 2, j);
        EXPECT_NEAR(moment(matter.mass, {i, j, 0}), 3 * exact, 1e-12 * exact);
        if (i + j <= 4) {
          EXPECT_NEAR(moment(matter.volume, {i, j, 0}), exact, 1e-9 * exact);
        }
      }
    }
    for (std::size_t i = 0; i < matter.volume.size(); ++i) {
      const Vec3& X = matter.volume.points_m[i];
      EXPECT_GT(matter.volume.weights[i], 0);
      EXPECT_TRUE(X.minCoeff() >= 0 && X.maxCoeff() < 2 && std::min(X.x(), X.y()) < 1);
    }
    EXPECT_LE(matter.volume.size(), 15u);  // as many as monomials up to degree 4
  }
  EXPECT_THROW(outlineMatter(corners, 0, MatterDetail::of(1)), Error);
  EXPECT_THROW(outlineMatter(std::span(corners).first(2), 1, MatterDetail::of(1)), Error);
}

}  // namespace
}  // namespace fascia
