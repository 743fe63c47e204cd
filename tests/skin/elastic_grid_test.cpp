#include <gtest/gtest.h>

#include <fascia/math/finite_difference.h>
#include <Eigen/Eigenvalues>

#include "grids.h"

namespace fascia {
namespace {

using test::GridCase, test::RandomGrid;

class ElasticGridTest : public testing::TestWithParam<GridCase> {};

// The energy's definition in elastic_grid.h, term by term and in double precision.
Eigen::VectorXd plainForces(const ElasticGrid& elastic, const Eigen::VectorXd& flat) {
  const GridLayout& g = elastic.layout();
  const ElasticGrid::Coefficients& c = elastic.coefficients();
  Eigen::VectorXd force = Eigen::VectorXd::Zero(flat.size());
  const auto index = [&](int i, int j) { return 3 * (j * g.columns + g.wrapped(i)); };
  const auto edge = [&](int p, int q, double w, double G) {
    const Vec3 e = flat.segment<3>(q) - flat.segment<3>(p);
    const double stress = std::clamp(e.squaredNorm() - G, -c.cap * G, c.cap * G);
    force.segment<3>(p) += w * stress * e;
    force.segment<3>(q) -= w * stress * e;
  };
  test::forEachPoint(g, [&](int i, int j, std::size_t k) {
    const int p00 = index(i, j), p10 = index(i + 1, j);
    if (c.w1[k] > 0) edge(p00, p10, c.w1[k], c.g1[k]);
    if (j + 1 == g.rows) return;
    const int p01 = index(i, j + 1), p11 = index(i + 1, j + 1);
    if (c.w2[k] > 0) edge(p00, p01, c.w2[k], c.g2[k]);
    if (c.w12[k] == 0) return;
    const Vec3 a = flat.segment<3>(p00), b = flat.segment<3>(p10);
    const Vec3 u = flat.segment<3>(p01), d = flat.segment<3>(p11);
    const Vec3 s1 = 0.5 * (b - a + d - u), s2 = 0.5 * (u - a + d - b);
    const double limit = c.lim12[k];
    const double f = 0.5 * c.w12[k] * std::clamp(s1.dot(s2) - c.g12[k], -limit, limit);
    force.segment<3>(p00) += f * (s1 + s2);
    force.segment<3>(p10) += f * (s1 - s2);
    force.segment<3>(p01) -= f * (s1 - s2);
    force.segment<3>(p11) -= f * (s1 + s2);
  });
  return force;
}

// Share of the edges that are stretched or squeezed beyond the stress plateau.
double plateauShare(const ElasticGrid& elastic, const VectorArray& r) {
  const ElasticGrid::Coefficients& c = elastic.coefficients();
  int edges = 0, beyond = 0;
  test::forEachPoint(elastic.layout(), [&](int, int, std::size_t k) {
    if (c.w1[k] == 0) return;
    ++edges;
    const double t = (test::at(r, k + 1) - test::at(r, k)).squaredNorm() - c.g1[k];
    beyond += std::abs(t) > c.cap * c.g1[k];
  });
  return static_cast<double>(beyond) / edges;
}

TEST_P(ElasticGridTest, ForceIsMinusTheGradientOfTheEnergy) {
  Random random(7);
  const GridLayout g = GetParam().layout();
  const RandomGrid grid(g, 1.4, random);
  for (const double amplitude : {0.1, 0.6, 1.5}) {
    const VectorArray r = grid.posture(amplitude, random);
    const Eigen::VectorXd gradient =
        test::energyGradient(g, r, [&](const VectorArray& x) { return grid.elastic.energy(x); });
    const Eigen::VectorXd force = test::flat(g, test::membraneForces(grid.elastic, r));
    EXPECT_LT(derivativeMismatch(-gradient, force), 2e-5) << amplitude;
    const double beyond = plateauShare(grid.elastic, r);
    EXPECT_GE(beyond, amplitude > 1 ? 0.3 : 0);
    EXPECT_LE(beyond, amplitude < 0.2 ? 0.3 : 1);
  }
}

TEST_P(ElasticGridTest, VectorisedForcesEqualAPlainLoop) {
  Random random(8);
  const GridLayout g = GetParam().layout();
  const RandomGrid grid(g, 1.4, random);
  const VectorArray r = grid.posture(1, random);
  const Eigen::VectorXd plain = plainForces(grid.elastic, test::flat(g, r));
  EXPECT_LT(derivativeMismatch(plain, test::flat(g, test::membraneForces(grid.elastic, r))), 2e-6);
}

TEST_P(ElasticGridTest, JacobianIsTheDerivativeOfTheForces) {
  Random random(9);
  const GridLayout g = GetParam().layout();
  const RandomGrid grid(g, 1.4, random);
  for (const double amplitude : {0.1, 1.0}) {
    const VectorArray r = grid.posture(amplitude, random);
    std::vector<Eigen::Triplet<double>> entries;
    grid.elastic.addForceJacobian(r, false, entries);
    Eigen::SparseMatrix<double> sparse(static_cast<Eigen::Index>(3 * g.pointCount()),
                                       static_cast<Eigen::Index>(3 * g.pointCount()));
    sparse.setFromTriplets(entries.begin(), entries.end());
    const Eigen::MatrixXd numeric =
        numericJacobian([&](const Eigen::VectorXd& x) { return plainForces(grid.elastic, x); },
                        test::flat(g, r), 1e-7);
    EXPECT_LT(derivativeMismatch(Eigen::MatrixXd(sparse), numeric), 1e-6) << amplitude;
  }
}

TEST_P(ElasticGridTest, EnergyIsTheSameAfterARigidMotion) {
  Random random(10);
  const GridLayout g = GetParam().layout();
  const RandomGrid grid(g, 1.4, random);
  const VectorArray r = grid.posture(0.7, random);
  const Transform motion{Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()).matrix(),
                         Vec3(0.4, -0.3, 0.2)};
  VectorArray moved(g.storage());
  test::forEachPoint(
      g, [&](int, int, std::size_t k) { test::put(moved, k, motion.point(test::at(r, k))); });
  fillPads(g, moved);
  const double energy = grid.elastic.energy(r);
  EXPECT_GT(energy, 0);
  EXPECT_NEAR(grid.elastic.energy(moved) / energy, 1, 1e-5);

  const VectorArray before = test::membraneForces(grid.elastic, r);
  const VectorArray after = test::membraneForces(grid.elastic, moved);
  const double size = test::flat(g, before).cwiseAbs().maxCoeff();
  test::forEachPoint(g, [&](int, int, std::size_t k) {
    const Vec3 turned = motion.vector(test::at(before, k));
    EXPECT_LT((turned - test::at(after, k)).norm(), 1e-5 * size);
  });
}

TEST_P(ElasticGridTest, ForcesHaveNeitherSumNorTorque) {
  Random random(11);
  const GridLayout g = GetParam().layout();
  const RandomGrid grid(g, 1.4, random);
  const VectorArray r = grid.posture(1, random);
  const VectorArray force = test::membraneForces(grid.elastic, r);
  Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
  double total = 0;
  test::forEachPoint(g, [&](int, int, std::size_t k) {
    sum += test::at(force, k);
    torque += test::at(r, k).cross(test::at(force, k));
    total += test::at(force, k).norm();
  });
  EXPECT_GT(total, 1);
  EXPECT_LT(sum.norm(), 1e-6 * total);
  EXPECT_LT(torque.norm(), 1e-6 * total);
}

TEST_P(ElasticGridTest, DefiniteJacobianHasNoPositiveEigenvalue) {
  Random random(12);
  const GridLayout g = GetParam().layout();
  const RandomGrid grid(g, 1.4, random);
  const VectorArray r = grid.posture(0.8, random);
  const auto largest = [&](bool definite) {
    std::vector<Eigen::Triplet<double>> entries;
    grid.elastic.addForceJacobian(r, definite, entries);
    Eigen::SparseMatrix<double> sparse(static_cast<Eigen::Index>(3 * g.pointCount()),
                                       static_cast<Eigen::Index>(3 * g.pointCount()));
    sparse.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(sparse),
                                                                Eigen::EigenvaluesOnly);
    return solver.eigenvalues().maxCoeff() / -solver.eigenvalues().minCoeff();
  };
  EXPECT_LT(largest(true), 1e-10);
  EXPECT_GT(largest(false), 1e-3);  // this posture has buckling directions
}

INSTANTIATE_TEST_SUITE_P(Widths, ElasticGridTest, testing::ValuesIn(test::gridCases()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace fascia
