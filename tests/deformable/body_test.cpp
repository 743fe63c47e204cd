#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <fascia/base/error.h>
#include <fascia/math/finite_difference.h>

#include "bodies.h"

namespace fascia {
namespace {

using test::view;

constexpr BodyMaterial kRubber{.rigidity_Pa = 2e4,
                               .volume_Pa = 5e4,
                               .relaxation_s = 0.01,
                               .power_damping_s_per_J = 0.02,
                               .drag_per_s = 0.5};

Eigen::VectorXd zero(const BodyShape& shape) {
  return Eigen::VectorXd::Zero(shape.coordinateCount());
}
Eigen::MatrixXd zeroMatrix(const BodyShape& shape) {
  return Eigen::MatrixXd::Zero(shape.coordinateCount(), shape.coordinateCount());
}
Eigen::VectorXd elasticForce(const BodyShape& shape, const Eigen::VectorXd& q) {
  Eigen::VectorXd f = zero(shape);
  shape.addElasticForce(view(q), view(f));
  return f;
}

TEST(BodyShape, CoordinatesAreMassNormalised) {
  for (const BasisPtr& basis : test::allBases()) {
    const auto shape = test::makeBar(basis);
    const Matter matter = boxMatter(basis->dimension(), test::boxOf(test::kBarSize_m), 1000,
                                    MatterDetail::of(*basis));
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(shape->shapeCount(), shape->shapeCount());
    for (std::size_t i = 0; i < matter.mass.size(); ++i) {
      const Eigen::VectorXd s = shape->pointWeights(matter.mass.points_m[i]);
      M += matter.mass.weights[i] * s * s.transpose();
    }
    EXPECT_LT((M - Eigen::MatrixXd::Identity(M.rows(), M.cols())).norm(), 1e-9) << basis->name();
  }
}

TEST(BodyShape, RestReproducesTheUndeformedBodyWithoutForce) {
  for (const BasisPtr& basis : test::allBases()) {
    const auto shape = test::makeBar(basis);
    Transform place;
    place.rotation = Eigen::AngleAxisd(1.1, Vec3::UnitZ()).toRotationMatrix();
    place.translation_m = Vec3(1, 2, 0);
    Eigen::VectorXd q = zero(*shape);
    shape->setRest(place, view(q));
    const Vec3 X(0.13, -0.03, basis->dimension() == 3 ? 0.02 : 0);
    EXPECT_LT((shape->point(view(q), X) - place.point(X)).norm(), 1e-10) << basis->name();
    EXPECT_LT((shape->deformationGradient(view(q), X) - place.rotation).norm(), 1e-9);
    EXPECT_NEAR(shape->energy(view(q)), 0, 1e-12);
    EXPECT_LT(elasticForce(*shape, q).norm(), 1e-6);
  }
}

TEST(BodyShape, ShapeMatrixIsThePapersR) {
  const auto shape = test::makeBar(makeAffineBasis(3));
  const Eigen::VectorXd q = test::deformed(*shape, 0.1, 9);
  const Eigen::MatrixXd R = shape->shapeMatrix(view(q));
  const Vec3 X(0.1, 0.02, -0.01);
  EXPECT_LT((R * Eigen::Vector4d(X.x(), X.y(), X.z(), 1) - shape->point(view(q), X)).norm(), 1e-13);
  Eigen::VectorXd back = zero(*shape);
  shape->setShapeMatrix(R, view(back));
  EXPECT_LT((back - q).norm(), 1e-13);
}

TEST(BodyShape, EnergyOfAStretchedBarIsThePapers) {
  // F = diag(a, b, c): V = vol (k_e Σ (a² − 1)² + k_c (abc − 1)²).
  const auto shape =
      test::makeBar(makePolynomialBasis(3, 2, test::boxOf(test::kBarSize_m)), kRubber);
  Eigen::VectorXd q = zero(*shape);
  Transform stretch;
  stretch.rotation = Vec3(1.2, 0.9, 1.1).asDiagonal();  // not a rotation: setRest is linear in it
  shape->setRest(stretch, view(q));
  const double strain = std::pow(0.44, 2) + std::pow(0.19, 2) + std::pow(0.21, 2);
  const double growth = 1.2 * 0.9 * 1.1 - 1;
  EXPECT_NEAR(shape->energy(view(q)), shape->volume_m3() * (2e4 * strain + 5e4 * growth * growth),
              1e-9);
}

TEST(BodyShape, ForceIsMinusTheGradientOfTheEnergy) {
  for (const BasisPtr& basis : test::allBases()) {
    const auto shape = test::makeBar(basis, kRubber);
    const Eigen::VectorXd q = test::deformed(*shape, 0.1, 4);
    const Eigen::VectorXd numeric =
        numericGradient([&](const Eigen::VectorXd& x) { return shape->energy(view(x)); }, q, 1e-5);
    EXPECT_LT(derivativeMismatch(-elasticForce(*shape, q), numeric), 1e-7) << basis->name();
  }
}

TEST(BodyShape, StiffnessIsTheHessianOfTheEnergy) {
  for (const BasisPtr& basis : test::allBases()) {
    const auto shape = test::makeBar(basis, kRubber);
    const Eigen::VectorXd q = test::deformed(*shape, 0.1, 5);
    Eigen::MatrixXd H = zeroMatrix(*shape);
    shape->addStiffness(view(q), 1, Curvature::exact, H);
    const Eigen::MatrixXd numeric = numericJacobian(
        [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return -elasticForce(*shape, x); }, q,
        1e-5);
    EXPECT_LT(derivativeMismatch(H, numeric), 1e-7) << basis->name();
  }
}

TEST(BodyShape, PositiveCurvatureIsPositiveWhereTheExactIsNot) {
  for (const BasisPtr& basis : test::allBases()) {
    const auto shape = test::makeBar(basis, kRubber);
    Eigen::VectorXd q = zero(*shape);
    Transform squeeze;
    squeeze.rotation = 0.6 * Mat3::Identity();
    shape->setRest(squeeze, view(q));
    Eigen::MatrixXd exact = zeroMatrix(*shape), positive = zeroMatrix(*shape);
    shape->addStiffness(view(q), 1, Curvature::exact, exact);
    shape->addStiffness(view(q), 1, Curvature::positive, positive);
    const double size = exact.norm();
    const auto lowest = [](const Eigen::MatrixXd& A) {
      return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(A).eigenvalues()[0];
    };
    EXPECT_LT(lowest(exact), -1e-3 * size) << basis->name();
    EXPECT_GT(lowest(positive), -1e-12 * size) << basis->name();
  }
}

TEST(BodyShape, PositiveCurvatureIsExactAtRest) {
  const auto shape =
      test::makeBar(makePolynomialBasis(3, 2, test::boxOf(test::kBarSize_m)), kRubber);
  Eigen::VectorXd q = zero(*shape);
  shape->setRest({}, view(q));
  Eigen::MatrixXd exact = zeroMatrix(*shape), positive = zeroMatrix(*shape);
  shape->addStiffness(view(q), 1, Curvature::exact, exact);
  shape->addStiffness(view(q), 1, Curvature::positive, positive);
  EXPECT_LT((exact - positive).norm(), 1e-9 * exact.norm());
}

TEST(BodyShape, DampingForceIsTheNegativeDampingMatrixTimesVelocity) {
  for (const BasisPtr& basis : test::allBases()) {
    const auto shape = test::makeBar(basis, kRubber);
    const Eigen::VectorXd q = test::deformed(*shape, 0.1, 6);
    const Eigen::VectorXd v = test::deformed(*shape, 0.5, 7);
    Eigen::VectorXd f = zero(*shape);
    shape->addDampingForce(view(q), view(v), view(f));
    Eigen::MatrixXd D = zeroMatrix(*shape);
    Eigen::VectorXd scratch = zero(*shape);
    shape->addDampingMatrix(view(q), 1, D, view(scratch));
    EXPECT_LT((f + D * v).norm(), 1e-10 * f.norm()) << basis->name();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(D);
    const double rounding = 1e-13 * D.norm();
    EXPECT_GT(solver.eigenvalues()[0], 0.49 - rounding) << basis->name();  // the drag is left
    EXPECT_GT(solver.eigenvalues()[1], -rounding);
  }
}

TEST(BodyShape, PowerDampingIsThePapers) {
  BodyMaterial material{.rigidity_Pa = 2e4, .volume_Pa = 5e4, .power_damping_s_per_J = 0.3};
  const auto shape = test::makeBar(makeAffineBasis(3), material);
  const Eigen::VectorXd q = test::deformed(*shape, 0.1, 6), v = test::deformed(*shape, 0.5, 7);
  const Eigen::VectorXd gradient = -elasticForce(*shape, q);
  Eigen::VectorXd f = zero(*shape);
  shape->addDampingForce(view(q), view(v), view(f));
  EXPECT_LT((f + 0.3 * gradient.dot(v) * gradient).norm(), 1e-12 * f.norm());
}

TEST(BodyShape, RelaxationLeavesRigidMotionAlone) {
  BodyMaterial material{.rigidity_Pa = 2e4, .volume_Pa = 0, .relaxation_s = 0.1};
  for (const BasisPtr& basis : test::allBases()) {
    const auto shape = test::makeBar(basis, material);
    const Eigen::VectorXd q = test::deformed(*shape, 0.05, 8);
    Eigen::VectorXd v = zero(*shape), f = zero(*shape);
    const Vec3 spin = basis->dimension() == 3 ? Vec3(1, 2, 3) : Vec3(0, 0, 3);
    shape->setRigidVelocity(view(q), {Vec3(1, 2, 0), spin, Vec3(0.3, 0.1, 0)}, view(v));
    shape->addDampingForce(view(q), view(v), view(f));
    EXPECT_LT(f.norm(), 1e-8) << basis->name();
    shape->addDampingForce(view(q), view(q), view(f));  // growing, that is
    EXPECT_GT(f.norm(), 1) << basis->name();
  }
}

TEST(BodyShape, RefusesMassThatLeavesAShapeFree) {
  const std::vector<Vec3> flat = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  const std::vector<double> masses(4, 1.0);
  EXPECT_THROW(BodyShape({makeAffineBasis(3), pointMatter(flat, masses, 1), {}}), Error);
  EXPECT_NO_THROW(BodyShape({makeAffineBasis(2), pointMatter(flat, masses, 1), {}}));
  BodyMaterial wrong;
  wrong.rigidity_Pa = -1;
  EXPECT_THROW(BodyShape({makeAffineBasis(2), pointMatter(flat, masses, 1), wrong}), Error);
}

}  // namespace
}  // namespace fascia
