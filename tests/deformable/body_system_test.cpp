#include <gtest/gtest.h>

#include <fascia/base/error.h>
#include <fascia/math/finite_difference.h>

#include "scenes.h"

namespace fascia {
namespace {

using test::linkEnd;
using test::view;

// Whole bodies of every basis in motion.

Eigen::VectorXd forces(BodySystem& system, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  Eigen::VectorXd f(q.size());
  evaluateForces(system, 0.3, view(q), view(v), view(f));
  return f;
}

TEST(BodySystem, JacobianIsTheDerivativeOfTheConstrainedForce) {
  OdeState state;
  const auto system = test::makeChain(2, state, {.rigidity_Pa = 2e3, .volume_Pa = 3e3});
  system->pull({makeNail("spring", {BodyId(1), linkEnd(1)}, Vec3(0.3, 0.1, 0)), 40, 0.5});
  Eigen::VectorXd q = Eigen::Map<Eigen::VectorXd>(state.r.data(), 24), v = q;
  Random random(3);
  for (double& x : q) x += random.uniform(-0.01, 0.01);
  for (double& x : v) x = random.uniform(-1, 1);
  SparseMatrix dfdr, dfdv;
  system->forceJacobian(0.3, view(q), view(v), dfdr, dfdv);
  const Eigen::MatrixXd byPlace =
      numericJacobian([&](const Eigen::VectorXd& x) { return forces(*system, x, v); }, q);
  const Eigen::MatrixXd byVelocity =
      numericJacobian([&](const Eigen::VectorXd& x) { return forces(*system, q, x); }, v);
  EXPECT_LT(derivativeMismatch(Eigen::MatrixXd(dfdr), byPlace), 1e-6);
  EXPECT_LT(derivativeMismatch(Eigen::MatrixXd(dfdv), byVelocity), 1e-6);
}

TEST(BodySystem, FallsFreelyWithEveryBasis) {
  for (const BasisPtr& basis : test::allBases()) {
    BodyModel model;
    model.add(test::makeBar(basis, {.rigidity_Pa = 1e4, .volume_Pa = 1e4}));
    BodySystem system(std::move(model));
    OdeState state = system.model().restState();
    BodyStepper stepper(system, {.scheme = BodyScheme::energyConserving});
    for (int i = 0; i < 20; ++i) stepper.step(0.01, state);
    const Vec3 X(0.1, 0.02, 0);
    const Vec3 fallen = system.model().point(state.r, {BodyId(0), X}) - X;
    EXPECT_LT((fallen - Vec3(0, -0.5 * 9.81 * 0.04, 0)).norm(), 1e-9) << basis->name();
  }
}

// How far the free end of a bar sinks that is nailed at the corners of one end face.
double sag(const BasisPtr& basis, double rigidity_Pa) {
  BodyModel model;
  model.add(test::makeBar(basis, {.rigidity_Pa = rigidity_Pa, .volume_Pa = 0, .drag_per_s = 20}));
  BodySystem system(std::move(model));
  OdeState state = system.model().restState();
  const Vec3 half = 0.5 * test::kBarSize_m;
  for (const double y : {-1, 1}) {
    const Vec3 corner(-half.x(), y * half.y(), 0);
    system.hold(makeNail("corner", {BodyId(0), corner}, corner));
  }
  BodyStepper stepper(system, {.tolerance = 1e-8});
  for (int i = 0; i < 120; ++i) stepper.step(1.0 / 30, state);
  return -system.model().point(state.r, {BodyId(0), Vec3(half.x(), 0, 0)}).y();
}

TEST(BodySystem, CantileverSagsAsBeamTheorySays) {
  // δ = q L⁴/(8 E I) + shear q L²/(2 κ G A): plane strain with λ = 0 has E = 2 µ = 8 k_e, G = 4
  // k_e.
  const double rigidity_Pa = 1e6, length = 0.4, height = 0.1, load = 1000 * 9.81 * height;
  const double bending =
      load * std::pow(length, 4) / (8 * 8 * rigidity_Pa * std::pow(height, 3) / 12);
  const double shear = load * length * length / (2 * 5.0 / 6 * 4 * rigidity_Pa * height);
  const Box box = test::boxOf(test::kBarSize_m);
  const double fine = sag(makePolynomialBasis(2, 4, box), rigidity_Pa);
  EXPECT_NEAR(fine, bending + shear, 0.05 * (bending + shear));
  // More freedom sags more, and the affine bar can only shear.
  const double quadratic = sag(makePolynomialBasis(2, 2, box), rigidity_Pa);
  const double affine = sag(makeAffineBasis(2), rigidity_Pa);
  EXPECT_LT(affine, 0.3 * quadratic);
  EXPECT_LT(quadratic, fine);
  // A lattice of order 4 along each axis has these polynomials and more.
  const double lattice = sag(makeBernsteinBasis(2, {4, 4, 0}, box), rigidity_Pa);
  EXPECT_GT(lattice, fine);
  EXPECT_LT(lattice, 1.2 * fine);
  // Modes from data come near what polynomials of many more coordinates reach.
  const auto everywhere = [](const Vec3&) { return true; };
  const double modes = sag(makeSkinningModesBasis(2, 3, box, 0.02, everywhere), rigidity_Pa);
  EXPECT_GT(modes, quadratic);
  EXPECT_LT(modes, lattice);
}

// Figure 1: a body held at the corners of its right end and pulled at the left. How much more its
// left end is turned than its middle.
double bend(const BasisPtr& basis) {
  BodyModel model;
  model.add(test::makeBar(basis, {.rigidity_Pa = 5e4, .volume_Pa = 5e4, .drag_per_s = 20}));
  BodySystem system(std::move(model), {.gravity_m_per_s2 = Vec3::Zero()});
  OdeState state = system.model().restState();
  const Vec3 half = 0.5 * test::kBarSize_m;
  for (const double y : {-1, 1}) {
    for (const double z : {-1, 1}) {
      const Vec3 corner(half.x(), y * half.y(), z * half.z());
      system.hold(makeNail("corner", {BodyId(0), corner}, corner));
    }
  }
  system.addPointForce({BodyId(0), Vec3(-half.x(), 0, 0)}, Vec3(-10, 10, 0));
  BodyStepper stepper(system, {.tolerance = 1e-8});
  for (int i = 0; i < 120; ++i) stepper.step(1.0 / 30, state);
  const auto turned = [&](double x) {
    const Mat3 F = system.model().shape(BodyId(0)).deformationGradient(state.r, Vec3(x, 0, 0));
    return std::atan2(F(1, 0), F(0, 0));
  };
  return std::abs(turned(-half.x()) - turned(0));
}

TEST(BodySystem, BendsThePapersBarWhereAnAffineBodyCannot) {
  EXPECT_GT(bend(makePolynomialBasis(3, 2, test::boxOf(test::kBarSize_m))), 0.05);
  EXPECT_LT(bend(makeAffineBasis(3)), 1e-12);
}

TEST(BodySystem, SwingsATriplePendulumInThePlane) {
  // Figure 2. Two dimensions, three affine parts, nailed at the top.
  BodyModel model;
  const auto part = test::makeBar(makeAffineBasis(2), {.rigidity_Pa = 1e5, .volume_Pa = 1e5});
  for (int i = 0; i < 3; ++i) model.add(part);
  BodySystem system(std::move(model));
  OdeState state = system.model().restState();
  for (int i = 0; i < 3; ++i)
    system.model().place(BodyId(i), {Mat3::Identity(), Vec3(0.4 * i, 0, 0)}, state);
  system.hold(makeNail("top", {BodyId(0), Vec3(-0.2, 0, 0)}, Vec3(-0.2, 0, 0)));
  for (int i = 1; i < 3; ++i)
    system.hold(
        makeAttachment("hinge", {BodyId(i - 1), Vec3(0.2, 0, 0)}, {BodyId(i), Vec3(-0.2, 0, 0)}));
  const double start = system.energy_J(state);
  BodyStepper stepper(system, {.scheme = BodyScheme::energyConserving});
  double lowest = 0;
  for (int i = 0; i < 240; ++i) {
    stepper.step(1.0 / 120, state);
    lowest = std::min(lowest, system.model().point(state.r, {BodyId(2), Vec3(0.2, 0, 0)}).y());
    EXPECT_LT(system.drift_m(state), 1e-9);
  }
  EXPECT_LT(lowest, -0.8);
  EXPECT_NEAR(system.energy_J(state), start, 1e-4);
}

TEST(BodySystem, RefusesBodiesOfDifferentDimensions) {
  BodyModel model;
  model.add(test::makeBar(makeAffineBasis(2)));
  EXPECT_THROW(model.add(test::makeBar(makeAffineBasis(3))), Error);
  EXPECT_THROW(BodySystem(BodyModel(), {.feedback_s = 0}), Error);
}

}  // namespace
}  // namespace fascia
