#include <gtest/gtest.h>

#include <fascia/skin/def/skin_def.h>

#include "grids.h"

namespace fascia {
namespace {

constexpr double kSheetWidth_m = 1.2, kSheetHeight_m = 0.8,
                 kArea_m2 = kSheetWidth_m * kSheetHeight_m;

ElasticGrid flatSheet(const GridLayout& g, double maxStretch) {
  return {g, test::sheet(g, kSheetWidth_m, kSheetHeight_m),
          test::uniformMaterial(g, 150, 70, 40, 1, maxStretch)};
}

VectorArray strained(const GridLayout& g, double stretchX, double stretchY, double shear) {
  VectorArray r = test::sheet(g, kSheetWidth_m, kSheetHeight_m);
  test::forEachPoint(g, [&](int, int, std::size_t k) {
    const Vec3 p = test::at(r, k);
    test::put(r, k, Vec3(stretchX * p.x() + shear * p.y(), stretchY * p.y(), 0));
  });
  fillPads(g, r);
  return r;
}

// St. Venant–Kirchhoff: ½ K E² per area with Green's strain E = (s² − 1)/2, and ½ S γ² for shear.
TEST(ElasticEnergy, OfUniformStrainIsTheClosedFormAtEveryResolution) {
  for (const int side : {9, 14, 33}) {
    const GridLayout g{side, side + 4, false};
    const ElasticGrid elastic = flatSheet(g, 2);
    const double s = 1.3, strain = 0.5 * (s * s - 1);
    const double expectedU = 0.5 * 150 * strain * strain * kArea_m2;
    const double expectedV = 0.5 * 70 * strain * strain * kArea_m2;
    EXPECT_NEAR(elastic.energy(strained(g, s, 1, 0)), expectedU, 1e-5 * expectedU) << side;
    EXPECT_NEAR(elastic.energy(strained(g, 1, s, 0)), expectedV, 1e-5 * expectedV) << side;
    EXPECT_NEAR(elastic.energy(strained(g, 1, 1, 0)), 0, 1e-9);
    // A shear also stretches the edges along v, by √(1 + γ²).
    const double shear = 0.1, along = 0.5 * shear * shear;
    const double expected = 0.5 * (40 * shear * shear + 70 * along * along) * kArea_m2;
    EXPECT_NEAR(elastic.energy(strained(g, 1, 1, shear)), expected, 1e-4 * expected) << side;
  }
}

// Beyond the plateau the stress is K (smax² − 1)/2 and the energy grows with the strain only.
TEST(ElasticEnergy, GrowsLinearlyWithStrainBeyondThePlateau) {
  const GridLayout g{17, 9, false};
  const double maxStretch = 1.4, plateau = 0.5 * (maxStretch * maxStretch - 1);
  const ElasticGrid elastic = flatSheet(g, maxStretch);
  for (const double s : {1.5, 3.0, 10.0}) {
    const double strain = 0.5 * (s * s - 1);
    const double expected = 150 * (plateau * strain - 0.5 * plateau * plateau) * kArea_m2;
    EXPECT_NEAR(elastic.energy(strained(g, s, 1, 0)), expected, 1e-5 * expected) << s;
  }
}

TEST(ElasticEnergy, IsLeastAtTheRelaxedLengths) {
  const GridLayout g{16, 8, false};
  const double prestretch = 1.25;
  const ElasticGrid elastic(g, test::sheet(g, kSheetWidth_m, kSheetHeight_m),
                            test::uniformMaterial(g, 150, 70, 40, prestretch, 2));
  const double relaxed = 1 / prestretch;
  EXPECT_NEAR(elastic.energy(strained(g, relaxed, relaxed, 0)), 0, 1e-9);
  EXPECT_GT(elastic.energy(strained(g, 1, 1, 0)), 1);
  EXPECT_GT(elastic.energy(strained(g, 0.9 * relaxed, relaxed, 0)), 0.1);
}

TEST(ElasticEnergy, HourglassPatternsCost) {
  const GridLayout g{16, 8, true};
  const ElasticGrid elastic(g, test::tube(g, 0.5, 0.8),
                            test::uniformMaterial(g, 150, 70, 0, 1, 1.4));
  VectorArray r = test::tube(g, 0.5, 0.8);
  const double still = elastic.energy(r);
  test::forEachPoint(g, [&](int i, int j, std::size_t k) {
    test::put(r, k, test::at(r, k) + Vec3(0, (i + j) % 2 ? 0.02 : -0.02, 0));
  });
  fillPads(g, r);
  EXPECT_GT(elastic.energy(r), still + 0.01);
}

TEST(ElasticGridStretch, IsTheLargestEdgeOverItsRestLengthWhateverThePrestretch) {
  for (const bool closed : {false, true}) {
    const GridLayout g{17, 9, closed};
    const VectorArray rest = test::restShape(g);
    const ElasticGrid elastic(g, rest, test::uniformMaterial(g, 150, 70, 40, 1.2, 1.4));
    EXPECT_NEAR(elastic.maxStretch(rest), 1, 1e-5);
    VectorArray r = rest;
    for (FloatArray* axis : {&r.x, &r.y, &r.z})
      for (float& x : *axis) x *= 1.5f;
    EXPECT_NEAR(elastic.maxStretch(r), 1.5, 1e-5);
    const std::size_t k = g.at(16, 8), below = g.at(16, 7);  // the last point of all
    const double length = (test::at(rest, k) - test::at(rest, below)).norm();
    r = rest;
    test::put(r, k, test::at(rest, below) + 7 * (test::at(rest, k) - test::at(rest, below)));
    fillPads(g, r);
    EXPECT_GE(elastic.maxStretch(r), 7 * (1 - 1e-5));
    EXPECT_GT(length, 0);
  }
}

// Explicit steps need λmax(K⁻¹ J) ≤ 1 with K the bound of every point and J = −∂f/∂r.
double scaledStiffness(const ElasticGrid& elastic, const VectorArray& r) {
  const GridLayout& g = elastic.layout();
  std::vector<Eigen::Triplet<double>> entries;
  elastic.addForceJacobian(r, false, entries);
  const auto n = static_cast<Eigen::Index>(3 * g.pointCount());
  Eigen::VectorXd scale(n);
  Eigen::Index p = 0;
  test::forEachPoint(g, [&](int, int, std::size_t k) {
    scale.segment<3>(p).setConstant(1 / std::sqrt(double{elastic.stiffnessBound()[k]}));
    p += 3;
  });
  Eigen::SparseMatrix<double> jacobian(n, n);
  jacobian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseMatrix<double> scaled = -(scale.asDiagonal() * jacobian * scale.asDiagonal());
  // Power iteration, shifted so that buckling directions do not compete.
  Eigen::VectorXd v(n);
  for (Eigen::Index i = 0; i < n; ++i) v[i] = std::sin(1.7 * static_cast<double>(i) + 0.3);
  double value = 0;
  for (int i = 0; i < 400; ++i) {
    v = scaled * v + 0.5 * v;
    value = v.norm();
    v /= value;
  }
  return value - 0.5;
}

TEST(StiffnessBound, HoldsForEveryPostureUpToThePlateau) {
  Random random(21);
  double largest = 0;
  for (const bool closed : {false, true}) {
    for (const double maxStretch : {1.05, 1.4, 3.0}) {
      const test::RandomGrid grid({17, 8, closed}, maxStretch, random);
      for (const double amplitude : {0.0, 0.1, 0.3, 0.6, 1.5})
        largest = std::max(largest, scaledStiffness(grid.elastic, grid.posture(amplitude, random)));
      VectorArray stretched = grid.rest;
      for (FloatArray* axis : {&stretched.x, &stretched.y, &stretched.z})
        for (float& x : *axis) x *= static_cast<float>(0.999 * maxStretch / 1.2);
      largest = std::max(largest, scaledStiffness(grid.elastic, stretched));
    }
  }
  EXPECT_LE(largest, 1);
  EXPECT_GT(largest, 0.1);  // a bound ten times too large would waste steps
  RecordProperty("largest_share", std::to_string(largest));
}

// The worst posture: both edges of every cell stretched to the plateau and folded onto one line,
// where their stiffnesses add up. The shear term of the default material pays for it.
TEST(StiffnessBound, HoldsForCellsFoldedOntoALine) {
  const SkinMaterialDef m;
  const GridLayout g{17, 17, false};
  const VectorArray rest = test::sheet(g, 1, 1);
  const ElasticGrid elastic(g, rest,
                            test::uniformMaterial(g, m.stretch_u_N_per_m, m.stretch_v_N_per_m,
                                                  m.shear_N_per_m, 1, m.max_stretch));
  VectorArray folded(g.storage());
  test::forEachPoint(g, [&](int, int, std::size_t k) {
    const Vec3 p = test::at(rest, k);
    test::put(folded, k, Vec3(0.999 * m.max_stretch * (p.x() + p.y()), 0, 0));
  });
  fillPads(g, folded);
  const double share = scaledStiffness(elastic, folded);
  EXPECT_LE(share, 1.001);
  EXPECT_GT(share, 0.5);
}

}  // namespace
}  // namespace fascia
