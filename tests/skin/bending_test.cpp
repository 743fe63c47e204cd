#include <gtest/gtest.h>

#include <fascia/math/finite_difference.h>
#include <fascia/skin/grid/bending.h>

#include "grids.h"

namespace fascia {
namespace {

using test::GridCase;

class BendingTest : public testing::TestWithParam<GridCase> {};

Bending randomBending(const GridLayout& g, Random& random, VectorArray& rest) {
  rest = test::restShape(g);
  test::scatter(g, 0.02, random, rest);
  FloatArray stiffness = test::constant(g, 0);
  for (float& k : stiffness) k = static_cast<float>(random.uniform(0, 2));
  return {g, rest, stiffness};
}

TEST_P(BendingTest, ForceIsMinusTheGradientOfTheEnergy) {
  Random random(31);
  const GridLayout g = GetParam().layout();
  VectorArray rest;
  const Bending bending = randomBending(g, random, rest);
  VectorArray r = rest, force(g.storage());
  test::scatter(g, 0.002, random, r);
  bending.addForces(r, force);
  const Eigen::VectorXd gradient =
      test::energyGradient(g, r, [&](const VectorArray& x) { return bending.energy(x); });
  EXPECT_LT(derivativeMismatch(-gradient, test::flat(g, force)), 1e-4);
}

// Also of folds that make cells lose most of their area.
TEST_P(BendingTest, StiffnessKeepsItsBoundHoweverTheGridIsCrushed) {
  Random random(34);
  const GridLayout g = GetParam().layout();
  VectorArray rest;
  const Bending bending = randomBending(g, random, rest);
  FloatArray bound = test::constant(g, 0);
  bending.addStiffnessBound(bound);
  const auto n = static_cast<Eigen::Index>(3 * g.pointCount());
  Eigen::VectorXd most(n);
  Eigen::Index at = 0;
  test::forEachPoint(g, [&](int, int, std::size_t k) {
    most.segment<3>(at).setConstant(bound[k]);
    at += 3;
  });
  for (const double amplitude : {0.0, 0.02, 0.15, 0.5}) {
    VectorArray r = rest;
    test::scatter(g, amplitude, random, r);
    std::vector<Eigen::Triplet<double>> entries;
    bending.addForceJacobian(r, entries);
    Eigen::SparseMatrix<double> jacobian(n, n);
    jacobian.setFromTriplets(entries.begin(), entries.end());
    // The stiffest direction, in the metric of the bound.
    Eigen::VectorXd direction = Eigen::VectorXd::Ones(n);
    for (Eigen::Index i = 0; i < n; ++i) direction[i] = random.uniform(-1, 1);
    for (int power = 0; power < 100; ++power) {
      direction = (-(jacobian * direction).array() / most.array().max(1e-12)).matrix();
      direction /= direction.norm();
    }
    const double stiffness = -direction.dot(jacobian * direction);
    EXPECT_GT(stiffness, 0) << amplitude;
    EXPECT_LT(stiffness, direction.dot(most.asDiagonal() * direction)) << amplitude;
  }
}

TEST_P(BendingTest, EnergyIsTheSameAfterARigidMotionAndForcesHaveNeitherSumNorTorque) {
  Random random(32);
  const GridLayout g = GetParam().layout();
  VectorArray rest;
  const Bending bending = randomBending(g, random, rest);
  VectorArray r = rest, force(g.storage()), moved(g.storage());
  test::scatter(g, 0.05, random, r);
  const Transform motion{Eigen::AngleAxisd(2.1, Vec3(1, 1, -0.5).normalized()).matrix(),
                         Vec3(-0.4, 0.3, 0.2)};
  test::forEachPoint(
      g, [&](int, int, std::size_t k) { test::put(moved, k, motion.point(test::at(r, k))); });
  const double energy = bending.energy(r);
  EXPECT_GT(energy, 1);
  EXPECT_NEAR(bending.energy(moved) / energy, 1, 1e-4);
  EXPECT_NEAR(bending.energy(rest) / energy, 0, 1e-9);

  bending.addForces(r, force);
  Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
  double total = 0;
  test::forEachPoint(g, [&](int, int, std::size_t k) {
    sum += test::at(force, k);
    torque += test::at(r, k).cross(test::at(force, k));
    total += test::at(force, k).norm();
  });
  EXPECT_LT(sum.norm(), 1e-6 * total);
  EXPECT_LT(torque.norm(), 1e-6 * total);
}

TEST_P(BendingTest, JacobianIsTheDerivativeOfTheForcesNearRest) {
  // The Jacobian is the Gauss–Newton part: exact where the curvature is that of the rest shape.
  Random random(33);
  const GridLayout g = GetParam().layout();
  VectorArray rest;
  const Bending bending = randomBending(g, random, rest);
  std::vector<Eigen::Triplet<double>> entries;
  bending.addForceJacobian(rest, entries);
  const auto n = static_cast<Eigen::Index>(3 * g.pointCount());
  Eigen::SparseMatrix<double> jacobian(n, n);
  jacobian.setFromTriplets(entries.begin(), entries.end());
  // Second differences of the energy along a few random directions.
  for (int trial = 0; trial < 5; ++trial) {
    VectorArray above = rest, below = rest;
    Eigen::VectorXd direction(n);
    Eigen::Index at = 0;
    constexpr double kStep_m = 0x1p-12;
    test::forEachPoint(g, [&](int, int, std::size_t k) {
      const Vec3 d(std::round(random.uniform(-1, 1) * 16) / 16, trial % 2, trial % 3);
      const Vec3 shift = kStep_m * (trial < 4 ? Vec3(d.x(), 0, d.x()) : d);
      direction.segment<3>(at) = shift / kStep_m;
      at += 3;
      test::put(above, k, test::at(rest, k) + shift);
      test::put(below, k, test::at(rest, k) - shift);
    });
    const double second = (bending.energy(above) + bending.energy(below)) / (kStep_m * kStep_m);
    const double expected = -direction.dot(jacobian * direction);
    EXPECT_GT(second, 1);
    EXPECT_NEAR(second / expected, 1, 2e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Widths, BendingTest, testing::ValuesIn(test::gridCases()),
                         testing::PrintToStringParamName());

// A sheet rolled to radius R has B11 = 1/R and the energy κ/2 · A / R² (an integral over the
// points whose stencil is complete).
TEST(Bending, OfARolledSheetCostsHalfStiffnessTimesCurvatureSquaredTimesArea) {
  const double radius = 0.7, width = 1, height = 0.5, stiffness = 0.3;
  double error[2];
  for (int n = 0; n < 2; ++n) {
    const GridLayout g{n == 0 ? 21 : 41, 11, false};
    const VectorArray rest = test::sheet(g, width, height);
    const Bending bending(g, rest, test::constant(g, stiffness));
    VectorArray rolled(g.storage());
    test::forEachPoint(g, [&](int, int, std::size_t k) {
      const Vec3 p = test::at(rest, k);
      const double angle = p.x() / radius;
      test::put(rolled, k, Vec3(radius * std::sin(angle), p.y(), radius * (1 - std::cos(angle))));
    });
    fillPads(g, rolled);
    const double area = width * (g.columns - 2) / (g.columns - 1) * height * 9 / 10;
    const double expected = 0.5 * stiffness * area / (radius * radius);
    error[n] = std::abs(bending.energy(rolled) / expected - 1);
  }
  EXPECT_LT(error[1], 1e-3);
  EXPECT_NEAR(error[0] / error[1], 4, 0.5);
}

TEST(Bending, VanishesWithoutStiffness) {
  const GridLayout g{16, 8, true};
  EXPECT_FALSE(Bending(g, test::restShape(g), test::constant(g, 0)).active());
  EXPECT_TRUE(Bending(g, test::restShape(g), test::constant(g, 1e-3)).active());
}

}  // namespace
}  // namespace fascia
