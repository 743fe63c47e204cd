#include <gtest/gtest.h>

#include <fascia/base/error.h>
#include <fascia/math/finite_difference.h>

#include "scenes.h"

namespace fascia {
namespace {

using test::linkEnd;

const BodyPoint kA{BodyId(0), linkEnd(1)}, kB{BodyId(1), linkEnd(-1)};

PathPoint circle(double t) {
  return {Vec3(std::cos(t), std::sin(t), t), Vec3(-std::sin(t), std::cos(t), 1),
          Vec3(-std::cos(t), -std::sin(t), 0)};
}

std::vector<ConstraintPtr> allConstraints() {
  return {makeAttachment("attachment", kA, kB),
          makeNail("nail", kA, Vec3(1, 2, 3)),
          makeTrajectory("trajectory", kA, circle),
          makePointOnLine("line", kA, Vec3(0, 1, 0), Vec3(1, 1, 2)),
          makePointOnPlane("plane", kA, Vec3(0, 1, 0), Vec3(1, -1, 2)),
          makeRod("rod", kA, kB, 0.7),
          makeTether("tether", kA, Vec3(1, 0, 0), 0.4)};
}

TEST(Constraint, DerivativesAreThoseOfTheValue) {
  for (const ConstraintPtr& constraint : allConstraints()) {
    const std::size_t points = constraint->points().size();
    const double t = 0.4;
    Random random(8);
    std::vector<Vec3> x(points), v(points);
    for (Vec3& p : x) p = Vec3(random.uniform(), random.uniform(), random.uniform());
    for (Vec3& p : v) p = Vec3(random.uniform(), random.uniform(), random.uniform());
    const auto valueAt = [&](double time, std::span<const Vec3> places) -> Eigen::VectorXd {
      ConstraintRows rows;  // without Jacobians
      constraint->evaluate(time, places, v, rows);
      return rows.value;
    };
    // Along the motion x + s v, with no acceleration of the points.
    const auto along = [&](double s) {
      std::vector<Vec3> moved = x;
      for (std::size_t i = 0; i < points; ++i) moved[i] += s * v[i];
      return valueAt(t + s, moved);
    };
    std::vector<Mat3> jacobian(points, Mat3::Zero());
    ConstraintRows rows;
    rows.jacobian = jacobian;
    constraint->evaluate(t, x, v, rows);
    Vec3 rate = rows.rate_m_per_s;
    for (std::size_t p = 0; p < points; ++p) {
      rate += jacobian[p] * v[p];
      const Eigen::MatrixXd numeric = numericJacobian(
          [&](const Eigen::VectorXd& at) {
            std::vector<Vec3> moved = x;
            moved[p] = at;
            return valueAt(t, moved);
          },
          x[p]);
      EXPECT_LT(derivativeMismatch(jacobian[p], numeric), 1e-8) << constraint->name();
    }
    const double h = 1e-4;
    EXPECT_LT((rate - (along(h) - along(-h)) / (2 * h)).norm(), 1e-7) << constraint->name();
    const Vec3 acceleration = (along(h) - 2 * along(0) + along(-h)) / (h * h);
    EXPECT_LT((rows.acceleration_m_per_s2 - acceleration).norm(), 1e-6) << constraint->name();
  }
}

TEST(Constraint, RefusesWhatItCannotHold) {
  EXPECT_THROW(makeRod("rod", kA, kB, 0), Error);
  EXPECT_THROW(makePointOnPlane("plane", kA, Vec3::Zero(), Vec3::Zero()), Error);
  EXPECT_THROW(makeTrajectory("path", kA, nullptr), Error);
  BodyModel one;
  one.add(test::makeLink());
  BodySystem system(std::move(one));
  EXPECT_THROW(system.hold(makeAttachment("far", kA, kB)), Error);
}

// ‖J q̇ + ∂c/∂t‖ over all constraints.
double velocityMismatch(BodySystem& system, const OdeState& state) {
  ConstraintSolver& solver = system.constraints();
  solver.update(state.t_s, state.r, state.v);
  double sum = 0;
  for (std::size_t i = 0; i < solver.list().size(); ++i)
    sum += (solver.list().jacobianTimes(i, state.v) + solver.list().rows(i).rate_m_per_s).norm();
  return sum;
}

TEST(ConstraintSolver, ForcesAreThoseOfTheDenseEquation) {
  // Eq. 8 with the whole J written out.
  OdeState state;
  const auto system = test::makeChain(4, state);
  system->hold(makePointOnPlane("plane", {BodyId(3), linkEnd(1)}, Vec3::Zero(), Vec3::UnitZ()));
  ConstraintSolver& solver = system->constraints();
  solver.update(0, state.r, {});
  const auto n = static_cast<Eigen::Index>(system->size());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(13, n);
  std::vector<double> unit(system->size(), 0.0);
  for (Eigen::Index j = 0; j < n; ++j) {
    unit[static_cast<std::size_t>(j)] = 1;
    for (long i = 0; i < 5; ++i)
      J.block(3 * i, j, i < 4 ? 3 : 1, 1) =
          solver.list().jacobianTimes(static_cast<std::size_t>(i), unit).head(i < 4 ? 3 : 1);
    unit[static_cast<std::size_t>(j)] = 0;
  }
  Eigen::VectorXd Q = Eigen::VectorXd::LinSpaced(n, -1, 3), constrained = Q;
  solver.project({constrained.data(), system->size()},
                 [](std::size_t) -> Vec3 { return Vec3::Zero(); });
  const Eigen::VectorXd lambda = (J * J.transpose()).llt().solve(-J * Q);
  EXPECT_LT((constrained - Q - J.transpose() * lambda).norm(), 1e-11);
  EXPECT_LT((J * constrained).norm(), 1e-11);
  EXPECT_GT((J * Q).norm(), 1);
}

TEST(ConstraintSolver, FactorsOnlyWhenTheConstraintsChange) {
  OdeState state;
  const auto system = test::makeChain(5, state);
  BodyStepper stepper(*system, {.scheme = BodyScheme::explicitEuler});
  for (int i = 0; i < 20; ++i) stepper.step(1e-3, state);
  EXPECT_EQ(system->constraints().factorizationCount(), 1);
  const ConstraintId extra = system->hold(makeNail("end", {BodyId(4), linkEnd(1)}, Vec3(1, 0, 0)));
  for (int i = 0; i < 20; ++i) stepper.step(1e-3, state);
  EXPECT_EQ(system->constraints().factorizationCount(), 2);
  EXPECT_TRUE(system->holds(extra));
  system->release(extra);
  EXPECT_FALSE(system->holds(extra));
  for (int i = 0; i < 20; ++i) stepper.step(1e-3, state);
  EXPECT_EQ(system->constraints().factorizationCount(), 3);
}

TEST(ConstraintSolver, FillGrowsInProportionToTheLengthOfAChain) {
  OdeState state;
  for (const int links : {10, 300}) {
    const auto system = test::makeChain(links, state);
    EXPECT_EQ(system->constraints().matrix().fillCount(), static_cast<std::size_t>(links - 1));
  }
}

TEST(Redundancies, AreNamedAndChangeNothingWhereTheyAgree) {
  OdeState state, plain;
  const auto once = test::makeChain(3, plain);
  const auto twice = test::makeChain(3, state);
  twice->hold(makeNail("same nail", {BodyId(0), linkEnd(-1)}, Vec3::Zero()));
  const std::vector<Redundancy> found = twice->redundancies(state);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].row_count, 3);
  EXPECT_NEAR(found[0].conflict_m, 0, 1e-12);
  const bool named = found[0].text() == "constraint 'same nail': 3 rows follow from 'nail'" ||
                     found[0].text() == "constraint 'nail': 3 rows follow from 'same nail'";
  EXPECT_TRUE(named) << found[0].text();
  for (const BodyScheme scheme :
       {BodyScheme::explicitEuler, BodyScheme::implicitEuler, BodyScheme::energyConserving}) {
    OdeState a = plain, b = plain;
    BodyStepper stepOnce(*once, {.scheme = scheme}), stepTwice(*twice, {.scheme = scheme});
    for (int i = 0; i < 30; ++i) stepOnce.step(5e-4, a), stepTwice.step(5e-4, b);
    double difference = 0;
    for (std::size_t i = 0; i < a.r.size(); ++i)
      difference = std::max(difference, std::abs(a.r[i] - b.r[i]));
    EXPECT_LT(difference, 1e-9);
  }
}

TEST(Redundancies, OfAClosedLoopOfRodsNameItsPartners) {
  // Three points of one affine body on a line: the third's nail follows from the other two.
  BodyModel model;
  model.add(test::makeLink());
  BodySystem system(std::move(model));
  const OdeState state = system.model().restState();
  system.hold(makeNail("left", {BodyId(0), linkEnd(-1)}, linkEnd(-1)));
  system.hold(makeNail("right", {BodyId(0), linkEnd(1)}, linkEnd(1)));
  system.hold(makeNail("middle", {BodyId(0), Vec3::Zero()}, Vec3(0, 0.01, 0)));
  const std::vector<Redundancy> found = system.redundancies(state);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].row_count, 3);
  EXPECT_EQ(found[0].others.size(), 2u);
  EXPECT_GT(found[0].conflict_m, 0.009);
  EXPECT_NE(found[0].text().find("it wants a place"), std::string::npos);
}

TEST(Redundancies, ThatContradictMeetInTheMiddle) {
  for (const BodyScheme scheme :
       {BodyScheme::explicitEuler, BodyScheme::implicitEuler, BodyScheme::energyConserving}) {
    BodyModel model;
    model.add(test::makeLink());
    BodySystem system(std::move(model));
    OdeState state = system.model().restState();
    const BodyPoint point{BodyId(0), linkEnd(-1)};
    system.hold(makeNail("here", point, linkEnd(-1)));
    system.hold(makeNail("there", point, linkEnd(-1) + Vec3(0.02, 0, 0)));
    BodyStepper stepper(system, {.scheme = scheme});
    for (int i = 0; i < 10; ++i) stepper.step(1e-3, state);
    const Vec3 middle = linkEnd(-1) + Vec3(0.01, 0, 0);
    EXPECT_LT((system.model().point(state.r, point) - middle).norm(), 1e-9);
  }
}

TEST(Impulses, MakeVelocitiesAgreeAndCostEnergy) {
  OdeState state;
  const auto system = test::makeChain(3, state);
  for (std::size_t i = 0; i < state.v.size(); ++i) state.v[i] = std::sin(static_cast<double>(i));
  const double before = system->model().kineticEnergy_J(state.v);
  EXPECT_GT(velocityMismatch(*system, state), 1);
  system->matchVelocities(state);
  EXPECT_LT(velocityMismatch(*system, state), 1e-12);
  EXPECT_LT(system->model().kineticEnergy_J(state.v), before);
}

TEST(Impulses, ConnectTwoFlyingBodiesLikeAnInelasticCollision) {
  // Equal bars that meet head on: the common velocity is the mean.
  BodyModel model;
  const BodyShapePtr link = test::makeLink();
  model.add(link), model.add(link);
  BodySystem system(std::move(model), {.gravity_m_per_s2 = Vec3::Zero()});
  OdeState state = system.model().restState();
  const auto fly = [&](int body, double speed) {
    link->setRigidVelocity(system.model().part(BodyId(body), std::span<const double>(state.r)),
                           {Vec3(speed, 0, 0), Vec3::Zero(), Vec3::Zero()},
                           system.model().part(BodyId(body), std::span<double>(state.v)));
  };
  fly(0, 3), fly(1, -1);
  const Vec3 momentum = system.model().momentum_Ns(state.v);
  const BodyPoint a{BodyId(0), Vec3::Zero()}, b{BodyId(1), Vec3::Zero()};
  system.hold(makeAttachment("grip", a, b));
  system.matchVelocities(state);
  EXPECT_LT((system.model().momentum_Ns(state.v) - momentum).norm(), 1e-12);
  EXPECT_NEAR(system.model().point(state.v, a).x(), 1, 1e-12);
  EXPECT_NEAR(system.model().point(state.v, b).x(), 1, 1e-12);
}

TEST(Impulses, OfABlowAreTheMomentum) {
  BodyModel model;
  model.add(test::makeLink());
  BodySystem system(std::move(model));
  OdeState state = system.model().restState();
  const BodyPoint end{BodyId(0), Vec3(0.1, 0.01, 0)};
  system.applyImpulse(end, Vec3(0, 0.5, 0.2), state);
  EXPECT_LT((system.model().momentum_Ns(state.v) - Vec3(0, 0.5, 0.2)).norm(), 1e-14);
  const Vec3 angular = end.X_m.cross(Vec3(0, 0.5, 0.2));
  EXPECT_LT((system.model().angularMomentum_Nms(state.r, state.v) - angular).norm(), 1e-14);
}

TEST(BodySystem, SatisfiesConstraintsFromAnIllegalState) {
  OdeState state;
  const auto system = test::makeChain(3, state);
  system->hold(makeTether("tether", {BodyId(2), linkEnd(1)}, Vec3(0.3, 0.4, 0), 0.2));
  for (double& x : state.r) x += 0.05;
  EXPECT_GT(system->drift_m(state), 0.01);
  system->satisfyConstraints(state);
  EXPECT_LT(system->drift_m(state), 1e-11);
}

}  // namespace
}  // namespace fascia
