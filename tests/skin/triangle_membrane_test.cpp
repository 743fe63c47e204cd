#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <fascia/math/finite_difference.h>

#include "grids.h"
#include "meshes.h"

namespace fascia {
namespace {

using test::MeshSheet, test::pointOf;

// A membrane and the postures that every statement about forces is tried in.
struct Posture {
  const char* name;
  VectorArray position;
  bool squeezed = false;  // so far that bending fades
};
std::vector<Posture> postures(const MeshSheet& sheet, Random& random) {
  std::vector<Posture> out;
  out.push_back({"at rest", sheet.rest});
  out.push_back({"scattered a little", sheet.scattered(0.05, random)});
  out.push_back({"scattered", sheet.scattered(0.4, random), true});
  out.push_back({"rolled", sheet.mapped([](const Vec3& p) {
                   const double a = p.x() / 0.4, radius = 0.4 + p.z();
                   return Vec3(radius * std::sin(a), p.y(), radius * std::cos(a));
                 })});
  out.push_back({"stretched", sheet.mapped([](const Vec3& p) {
                   return Vec3(1.25 * p.x(), 0.9 * p.y(), p.z() + 0.1 * p.x());
                 })});
  out.push_back({"sheared", sheet.mapped([](const Vec3& p) {
                   return Vec3(p.x() + 0.3 * p.y(), p.y(), p.z());
                 })});
  out.push_back({"folded", sheet.mapped([](const Vec3& p) {
                   return p.x() < 0.2 ? p : Vec3(0.4 - p.x(), p.y(), p.z() + 0.3 * (p.x() - 0.2));
                 }),
                 true});
  out.push_back({"beyond the plateau", sheet.mapped([](const Vec3& p) {
                   return Vec3(2.1 * p.x() + 1.3 * p.y(), 1.9 * p.y(), p.z());
                 })});
  return out;
}

TEST(TriangleMembrane, ForceIsMinusTheGradientOfTheEnergy) {
  Random random(31);
  MeshSheet sheet = test::unevenSheet(7, 6, random);
  for (const double bending : {0.0, 0.3}) {
    sheet.setBending(bending);
    const TriangleMembrane membrane = sheet.membrane();
    EXPECT_EQ(membrane.hinges().empty(), bending == 0);
    for (const Posture& posture : postures(sheet, random)) {
      if (bending > 0 && posture.squeezed) continue;
      const Eigen::VectorXd gradient =
          test::energyGradient(posture.position, sheet.count(),
                               [&](const VectorArray& r) { return membrane.energy(r); });
      const Eigen::VectorXd force =
          test::flatten(test::forcesOf(membrane, posture.position), sheet.count());
      EXPECT_GT(force.norm(), 0.1) << posture.name;
      EXPECT_LT(derivativeMismatch(-gradient, force), 3e-5) << posture.name << ", " << bending;
    }
  }
}

TEST(TriangleMembrane, JacobianIsTheDerivativeOfTheForces) {
  Random random(32);
  const MeshSheet sheet = test::unevenSheet(5, 4, random);
  const TriangleMembrane membrane = sheet.membrane();
  const auto n = static_cast<Eigen::Index>(3 * sheet.count());
  for (const Posture& posture : postures(sheet, random)) {
    std::vector<Eigen::Triplet<double>> entries;
    membrane.addForceJacobian(posture.position, false, entries);
    Eigen::SparseMatrix<double> sparse(n, n);
    sparse.setFromTriplets(entries.begin(), entries.end());
    const Eigen::MatrixXd numeric =
        numericJacobian([&](const Eigen::VectorXd& x) { return test::plainForces(membrane, x); },
                        test::flatten(posture.position, sheet.count()), 1e-7);
    EXPECT_LT(derivativeMismatch(Eigen::MatrixXd(sparse), numeric), 1e-6) << posture.name;
  }
}

// A fold's own Jacobian, where its angle is the rest angle: no stress, only k ∂θ/∂r ∂θ/∂rᵀ.
TEST(TriangleMembrane, BendingJacobianIsTheDerivativeOfUnstressedForces) {
  Random random(33);
  MeshSheet sheet = test::unevenSheet(4, 4, random);
  sheet.setMaterial(0, 0, 0);
  sheet.setBending(0.5);
  const TriangleMembrane membrane = sheet.membrane();
  const auto n = static_cast<Eigen::Index>(3 * sheet.count());
  std::vector<Eigen::Triplet<double>> entries;
  membrane.addForceJacobian(sheet.rest, true, entries);
  Eigen::SparseMatrix<double> sparse(n, n);
  sparse.setFromTriplets(entries.begin(), entries.end());
  Eigen::MatrixXd numeric(n, n);
  constexpr float kStep_m = 0x1p-11f;
  VectorArray r = sheet.rest;
  for (Eigen::Index j = 0; j < n; ++j) {
    FloatArray& axis = j % 3 == 0 ? r.x : j % 3 == 1 ? r.y : r.z;
    float& x = axis[static_cast<std::size_t>(j / 3)];
    const float there = x;
    x = there + kStep_m;
    const Eigen::VectorXd above = test::flatten(test::forcesOf(membrane, r), sheet.count());
    x = there - kStep_m;
    const Eigen::VectorXd below = test::flatten(test::forcesOf(membrane, r), sheet.count());
    x = there;
    numeric.col(j) = (above - below) / (2.0 * kStep_m);
  }
  EXPECT_LT(derivativeMismatch(Eigen::MatrixXd(sparse), numeric), 2e-3);
}

TEST(TriangleMembrane, DefiniteJacobianHasNoPositiveEigenvalue) {
  Random random(34);
  MeshSheet sheet = test::unevenSheet(5, 5, random);
  sheet.setBending(0.2);
  const TriangleMembrane membrane = sheet.membrane();
  const auto n = static_cast<Eigen::Index>(3 * sheet.count());
  const VectorArray r = sheet.scattered(0.8, random);
  const auto largest = [&](bool definite) {
    std::vector<Eigen::Triplet<double>> entries;
    membrane.addForceJacobian(r, definite, entries);
    Eigen::SparseMatrix<double> sparse(n, n);
    sparse.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd(sparse),
                                                                Eigen::EigenvaluesOnly);
    return solver.eigenvalues().maxCoeff() / -solver.eigenvalues().minCoeff();
  };
  EXPECT_LT(largest(true), 1e-10);
  EXPECT_GT(largest(false), 1e-3);  // this posture has buckling directions
}

TEST(TriangleMembrane, FeelsNoRigidMotion) {
  Random random(35);
  MeshSheet sheet = test::unevenSheet(7, 6, random);
  sheet.setMaterial(200, 120, 60);
  sheet.setBending(0.1);
  const TriangleMembrane membrane = sheet.membrane();
  const Transform motion{Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()).matrix(),
                         Vec3(0.4, -0.3, 0.2)};
  const auto moved = [&](const VectorArray& from) {
    VectorArray to = from;
    for (std::size_t k = 0; k < sheet.count(); ++k)
      test::putPoint(to, k, motion.point(pointOf(from, k)));
    return to;
  };
  const VectorArray strained = sheet.scattered(0.3, random);
  const VectorArray force = test::forcesOf(membrane, strained);
  const double size = test::flatten(force, sheet.count()).cwiseAbs().maxCoeff();
  EXPECT_GT(size, 1);
  EXPECT_NEAR(membrane.energy(moved(strained)) / membrane.energy(strained), 1, 1e-4);
  const VectorArray turned = test::forcesOf(membrane, moved(strained));
  const VectorArray still = test::forcesOf(membrane, moved(sheet.rest));
  for (std::size_t k = 0; k < sheet.count(); ++k) {
    EXPECT_LT((motion.vector(pointOf(force, k)) - pointOf(turned, k)).norm(), 2e-4 * size);
    EXPECT_LT(pointOf(still, k).norm(), 2e-4 * size);
  }
}

// Also where bending fades: squeezed to almost a line.
TEST(TriangleMembrane, ForcesHaveNeitherSumNorTorque) {
  Random random(36);
  MeshSheet sheet = test::unevenSheet(7, 6, random);
  sheet.setBending(2);
  const TriangleMembrane membrane = sheet.membrane();
  const VectorArray squeezed = sheet.mapped(
      [](const Vec3& p) { return Vec3(p.x(), 0.02 * p.y() + 0.03 * p.x(), 5 * p.z() * p.x()); });
  for (const VectorArray& r : {sheet.scattered(1, random), squeezed}) {
    const VectorArray force = test::forcesOf(membrane, r);
    Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
    double total = 0;
    for (std::size_t k = 0; k < sheet.count(); ++k) {
      sum += pointOf(force, k);
      torque += pointOf(r, k).cross(pointOf(force, k));
      total += pointOf(force, k).norm();
    }
    EXPECT_GT(total, 1);
    EXPECT_LT(sum.norm(), 1e-5 * total);
    EXPECT_LT(torque.norm(), 1e-5 * total);
  }
}

// An affine map of a sheet, ½[K_u E_uu² + K_v E_vv² + S (2E_uv)²] times its area.
double affineEnergy(const Eigen::Matrix<double, 3, 2>& map, const Vec2& u, double stretchU,
                    double stretchV, double shear, double prestretch, double area) {
  const Vec2 v(-u.y(), u.x());
  const Vec3 xu = prestretch * (map * u), xv = prestretch * (map * v);
  const double eu = 0.5 * (xu.squaredNorm() - 1), ev = 0.5 * (xv.squaredNorm() - 1);
  return 0.5 * area * (stretchU * eu * eu + stretchV * ev * ev + shear * std::pow(xu.dot(xv), 2));
}

TEST(TriangleMembrane, AffineMapsCostTheClosedFormOnAnyTriangulation) {
  Random random(37);
  Eigen::Matrix<double, 3, 2> map;
  map << 1.1, 0.08, -0.05, 0.93, 0.1, 0.06;
  for (const double jitter : {0.0, 0.25}) {
    for (const double angle : {0.0, 0.4, 1.9}) {
      MeshSheet sheet(9, 7, 0.9, 0.7);
      const VectorArray border = sheet.rest;
      sheet.rest = sheet.scattered(jitter, random, true);
      for (int j = 0; j < sheet.rows; ++j)
        for (int i = 0; i < sheet.columns; ++i)
          if (i == 0 || j == 0 || i + 1 == sheet.columns || j + 1 == sheet.rows)
            test::putPoint(sheet.rest, sheet.at(i, j), pointOf(border, sheet.at(i, j)));
      sheet.setMaterial(190, 80, 45, 1.07);
      const Vec2 u(std::cos(angle), std::sin(angle));
      sheet.setDirection({u.x(), u.y(), 0.5});  // only its part in the plane counts
      const VectorArray r = sheet.mapped([&](const Vec3& p) { return Vec3(map * p.head<2>()); });
      const double expected = affineEnergy(map, u, 190, 80, 45, 1.07, 0.9 * 0.7);
      EXPECT_NEAR(sheet.membrane().energy(r) / expected, 1, 1e-4) << jitter << ", " << angle;
    }
  }
}

TEST(TriangleMembrane, IsotropicMaterialHasNoDirection) {
  Random random(38);
  MeshSheet sheet = test::unevenSheet(8, 7, random);
  sheet.setMaterial(150, 150, 75, 1.05);
  sheet.material.max_stretch = 3;
  const VectorArray r = sheet.scattered(0.15, random);
  sheet.material.u.clear();
  const double any = sheet.membrane().energy(r);
  for (const double angle : {0.0, 0.7, 2.0}) {
    sheet.setDirection({std::cos(angle), std::sin(angle), 0});
    EXPECT_NEAR(sheet.membrane().energy(r) / any, 1, 1e-5) << angle;
  }
  sheet.setMaterial(150, 250, 75, 1.05);
  EXPECT_GT(std::abs(sheet.membrane().energy(r) / any - 1), 0.05);
}

TEST(TriangleMembrane, CostsWhatAGridOfTheSameMaterialCosts) {
  const GridLayout g{17, 13, false};
  const VectorArray gridRest = test::sheet(g, 0.8, 0.6);
  const ElasticGrid grid(g, gridRest, test::uniformMaterial(g, 190, 80, 45, 1.1, 1.4));
  MeshSheet sheet(17, 13, 0.8, 0.6);
  sheet.setMaterial(190, 80, 45, 1.1);
  sheet.setDirection(Vec3::UnitX());
  const TriangleMembrane membrane = sheet.membrane();
  const auto compare = [&](const auto& map, double tolerance) {
    VectorArray r(g.storage());
    test::forEachPoint(
        g, [&](int, int, std::size_t k) { test::put(r, k, map(test::at(gridRest, k))); });
    fillPads(g, r);
    const double expected = grid.energy(r);
    EXPECT_GT(expected, 0.1);
    EXPECT_NEAR(membrane.energy(sheet.mapped(map)) / expected, 1, tolerance);
  };
  compare([](const Vec3& p) { return p; }, 1e-4);
  compare([](const Vec3& p) { return Vec3(1.08 * p.x(), 0.9 * p.y(), 0); }, 1e-4);
  compare([](const Vec3& p) { return Vec3(p.x() + 0.2 * p.y(), p.y(), 0); }, 1e-4);
  compare([](const Vec3& p) { return Vec3(1.9 * p.x(), p.y(), 0); }, 1e-4);  // on the plateau
  compare(
      [](const Vec3& p) {
        return Vec3(p.x() + 0.04 * std::sin(5 * p.y()), p.y() * (1 + 0.1 * p.x()), 0.1 * p.x());
      },
      0.02);
}

TEST(TriangleMembrane, EnergyConvergesWithSecondOrder) {
  const auto map = [](const Vec3& p) {
    return Vec3(p.x() + 0.05 * std::sin(4 * p.y()), p.y() + 0.04 * p.x() * p.x(),
                0.1 * std::cos(3 * p.x()));
  };
  const auto error = [&](int cells) {
    MeshSheet sheet(cells + 1, cells + 1, 1, 1);
    sheet.setMaterial(190, 80, 45);
    sheet.setDirection(Vec3::UnitX());
    // Midpoint rule on many small squares, derivatives by central differences.
    constexpr int kSquares = 200;
    double exact = 0;
    for (int j = 0; j < kSquares; ++j) {
      for (int i = 0; i < kSquares; ++i) {
        const Vec3 p((i + 0.5) / kSquares, (j + 0.5) / kSquares, 0);
        constexpr double kStep = 1e-5;
        Eigen::Matrix<double, 3, 2> d;
        d.col(0) = (map(p + kStep * Vec3::UnitX()) - map(p - kStep * Vec3::UnitX())) / (2 * kStep);
        d.col(1) = (map(p + kStep * Vec3::UnitY()) - map(p - kStep * Vec3::UnitY())) / (2 * kStep);
        exact += affineEnergy(d, Vec2::UnitX(), 190, 80, 45, 1, 1.0 / (kSquares * kSquares));
      }
    }
    return std::abs(sheet.membrane().energy(sheet.mapped(map)) - exact) / exact;
  };
  const double coarse = error(8), fine = error(32);
  EXPECT_LT(fine, 0.005);
  EXPECT_NEAR(std::log2(coarse / fine) / 2, 2, 0.2);
}

TEST(HingeBending, ACylinderCostsHalfTheStiffnessTimesCurvatureSquared) {
  constexpr double kBending_Nm = 0.7, kRadius_m = 0.5;
  const auto rolled = [&](const Vec3& p) {
    const double a = p.x() / kRadius_m;
    return Vec3(kRadius_m * std::sin(a), p.y(), kRadius_m * (1 - std::cos(a)));
  };
  for (const int cells : {16, 48}) {
    MeshSheet sheet(cells + 1, cells + 1, 1, 1);
    sheet.setMaterial(0, 0, 0);
    sheet.setBending(kBending_Nm);
    const double expected = 0.5 * kBending_Nm / (kRadius_m * kRadius_m);
    // The two border columns of hinges are missing: one cell's width of the sheet.
    const double missing = 1.0 / cells;
    EXPECT_NEAR(sheet.membrane().energy(sheet.mapped(rolled)) / expected, 1 - missing, 0.01);

    sheet.rest = sheet.mapped(rolled);
    EXPECT_LT(sheet.membrane().energy(sheet.rest), 1e-6);
    const auto back = [&](const Vec3& p) {
      return Vec3(kRadius_m * std::asin(p.x() / kRadius_m), p.y(), 0);
    };
    MeshSheet quarter(cells + 1, cells + 1, 0.7, 0.7);
    quarter.setMaterial(0, 0, 0);
    quarter.setBending(kBending_Nm);
    quarter.rest = quarter.mapped(rolled);
    EXPECT_NEAR(quarter.membrane().energy(quarter.mapped(back)) / (0.49 * expected), 1 - missing,
                0.02);
  }
}

TEST(HingeBending, FoldsTheWholeWayRoundWithoutAJump) {
  MeshSheet sheet(2, 3, 0.1, 0.2);
  sheet.setMaterial(0, 0, 0);
  sheet.setBending(1);
  sheet.rest = sheet.mapped([](const Vec3& p) {  // rest folded to 150°
    const double over = p.y() - 0.1, a = radians(150);
    return over <= 0 ? p : Vec3(p.x(), 0.1 + over * std::cos(a), over * std::sin(a));
  });
  const TriangleMembrane membrane = sheet.membrane();
  double before = -1;
  for (int degree = 150; degree <= 320; degree += 10) {  // through 180°, less than 180° from rest
    const VectorArray r = sheet.mapped([&](const Vec3& p) {
      const double a = radians(degree), over = (p - Vec3(p.x(), 0.1, 0)).norm();
      return p.y() <= 0.1 && p.z() == 0 ? p
                                        : Vec3(p.x(), 0.1 + over * std::cos(a), over * std::sin(a));
    });
    const double energy = membrane.energy(r);
    EXPECT_GT(energy, before - 1e-9) << degree;
    before = energy;
  }
  EXPECT_GT(before, 1);
}

TEST(TriangleMembrane, AreasAreThoseOfTheRestShape) {
  const TriangleMembrane membrane = MeshSheet(9, 7, 0.9, 0.7).membrane();
  double total = 0;
  for (const float area : membrane.pointAreas()) total += area;
  EXPECT_NEAR(total, 0.63, 1e-5);
}

TEST(TriangleMembrane, MaxStretchIsTheLongestEdgeOverItsRestLength) {
  MeshSheet sheet(9, 7, 0.9, 0.7);
  sheet.setMaterial(150, 150, 60, 1.2);
  const TriangleMembrane membrane = sheet.membrane();
  EXPECT_NEAR(membrane.maxStretch(sheet.rest), 1, 1e-4);
  VectorArray r = sheet.rest;
  const std::uint32_t last = sheet.at(8, 6), below = sheet.at(8, 5);
  test::putPoint(r, last, pointOf(r, below) + 7 * (pointOf(r, last) - pointOf(r, below)));
  EXPECT_NEAR(membrane.maxStretch(r), 7, 1e-3);
}

TEST(TriangleMembrane, TrianglesWithoutAreaHaveNoStiffness) {
  MeshSheet sheet(5, 5, 0.4, 0.4);
  const double before = sheet.membrane().stiffnessBound()[12];
  const std::size_t kept = sheet.membrane().triangles().size();
  test::putPoint(sheet.rest, 30, {0.5, 0.5, 0});
  sheet.triangles.push_back({12, 12, 13});
  sheet.triangles.push_back({0, 1, 2});  // on a line
  sheet.triangles.push_back({30, 31, 31});
  sheet.setBending(1);
  const TriangleMembrane membrane = sheet.membrane();
  EXPECT_EQ(membrane.triangles().size(), kept);
  EXPECT_EQ(membrane.stiffnessBound()[30], 0);
  EXPECT_GE(membrane.stiffnessBound()[12], before);
}

TEST(TriangleMembrane, SliversDoNotOutweighTheirNeighbours) {
  const auto boundOf = [](double height) {
    MeshSheet sheet(2, 2, 1, height);
    const TriangleMembrane membrane = sheet.membrane();
    return *std::max_element(membrane.stiffnessBound().begin(), membrane.stiffnessBound().end());
  };
  EXPECT_LT(boundOf(1e-3), 12 * boundOf(1));
  EXPECT_LT(boundOf(0.1), 12 * boundOf(1));
}

TEST(TriangleMembrane, CollapsedPosturesGiveFiniteForces) {
  Random random(40);
  MeshSheet sheet = test::unevenSheet(7, 6, random);
  sheet.setBending(1);
  const TriangleMembrane membrane = sheet.membrane();
  VectorArray r(sheet.rest.size());
  EXPECT_TRUE(test::allFinite(test::forcesOf(membrane, r)));  // all in one point
  r = sheet.mapped([](const Vec3& p) { return Vec3(p.x(), 0, 0); });
  EXPECT_TRUE(test::allFinite(test::forcesOf(membrane, r)));  // on a line
  r = sheet.rest;
  test::putPoint(r, sheet.at(3, 3), pointOf(r, sheet.at(4, 3)));
  EXPECT_TRUE(test::allFinite(test::forcesOf(membrane, r)));  // an edge without length
}

}  // namespace
}  // namespace fascia
