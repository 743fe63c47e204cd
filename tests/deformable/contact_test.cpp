#include <gtest/gtest.h>

#include <fascia/base/error.h>

#include "contact_scenes.h"
#include "support/steep_field.h"

// A body against the ground and against solids that do not feel it.

namespace fascia {
namespace {

using test::BoxScene;
using test::kFrame_s;

constexpr double kEdge_m = 0.2, kMargin_m = 0.002;  // a hundredth of it

Vec3 slope(double angle) {
  return 9.81 * Vec3(std::sin(angle), -std::cos(angle), 0);
}

TEST(Contact, ABoxRestsOnTheGroundForTenSeconds) {
  BoxScene scene({{}}, {.ground_m = 0});
  scene.place(0, Vec3(0, 0.5 * kEdge_m + kMargin_m, 0));
  BodyStepper stepper(*scene.system);
  advance(stepper, scene, 60);
  const Vec3 settled = scene.center(0);
  advance(stepper, scene, 540);
  EXPECT_GT(scene.lowest_m(), 0);
  EXPECT_LT(scene.lowest_m(), kMargin_m);
  EXPECT_LT((scene.center(0) - settled).norm(), 1e-5);
  double load_N = 0;
  const ContactSet& set = scene.contacts->contacts();
  for (std::size_t i = 0; i < set.size(); ++i) load_N += set.force_N(i).y();
  EXPECT_NEAR(load_N, 8 * 9.81, 0.01);
  EXPECT_EQ(stepper.stats().halved, 0u);
}

TEST(Contact, FrictionHoldsBelowItsAngle) {
  const double creep_per_s = 1e-3;
  BoxScene scene({{}}, {.ground_m = 0, .friction = 0.5, .creep_per_s = creep_per_s}, slope(0.44));
  scene.place(0, Vec3(0, 0.5 * kEdge_m + 0.5 * kMargin_m, 0));
  BodyStepper stepper(*scene.system);
  advance(stepper, scene, 60);
  const double settled = scene.center(0).x();
  advance(stepper, scene, 600);
  EXPECT_LT(scene.center(0).x() - settled, creep_per_s * kEdge_m * 10);
  EXPECT_GT(scene.lowest_m(), 0);
}

TEST(Contact, SlidesAsCoulombSaysAboveThatAngle) {
  const double angle = 0.7, friction = 0.5;
  BoxScene scene({{}}, {.ground_m = 0, .friction = friction}, slope(angle));
  scene.place(0, Vec3(0, 0.5 * kEdge_m + 0.5 * kMargin_m, 0));
  BodyStepper stepper(*scene.system);
  advance(stepper, scene, 60);
  const double before = scene.velocity(0).x();
  advance(stepper, scene, 60);
  const double expected = 9.81 * (std::sin(angle) - friction * std::cos(angle));
  EXPECT_NEAR(scene.velocity(0).x() - before, expected, 0.01 * expected);
}

TEST(Contact, ASoftBallComesToRestOutsideOfTheGround) {
  const Solid ball = test::makeSolid(test::sphereDef(0.1));
  BodyModel model;
  model.add(std::make_shared<BodyShape>(
      BodyDef{makePolynomialBasis(3, 2, ball.bounds()),
              solidMatter(ball, 1000, 0.02, MatterDetail::of(2)),
              {.rigidity_Pa = 5e3, .volume_Pa = 1e4, .relaxation_s = 0.01}}));
  BodySystem system(std::move(model));
  const BodySurfacePtr surface = makeSolidSurface(ball, 12);
  system.setContacts({.ground_m = 0}).setSurface(BodyId(0), surface);
  OdeState state = system.model().restState();
  system.model().place(BodyId(0), {Mat3::Identity(), Vec3(0, 1, 0)}, state);
  BodyStepper stepper(system);
  double highestSpeed = 0;
  for (int i = 0; i < 240; ++i) {
    stepper.step(kFrame_s, state);
    const double speed = system.model().point(state.v, {BodyId(0), Vec3::Zero()}).norm();
    highestSpeed = std::max(highestSpeed, speed);
    for (const Eigen::Vector3f& X : surface->mesh().positions)
      ASSERT_GT(system.model().point(state.r, {BodyId(0), X.cast<double>()}).y(), -1e-4);
  }
  EXPECT_GT(highestSpeed, 3);  // it did fall
  EXPECT_LT(system.model().point(state.v, {BodyId(0), Vec3::Zero()}).norm(), 2e-3);
}

TEST(Contact, EnergyNeverGrows) {
  BoxScene scene({{}}, {.ground_m = 0, .friction = 0.4});
  scene.place(0, Vec3(0, 0.6, 0), 0.8);
  BodyStepper stepper(*scene.system,
                      {.contact_tolerance = 1e-8, .contact_patience = 200, .max_iterations = 200});
  const double start = scene.energy_J();
  double before = start;
  for (int i = 0; i < 180; ++i) {
    stepper.step(kFrame_s, scene.state);
    EXPECT_LT(scene.energy_J(), before + 1e-6 * start) << i;
    before = scene.energy_J();
  }
  EXPECT_LT(before, 0.5 * start);
  EXPECT_GT(scene.lowest_m(), 0);
}

TEST(Contact, FastBodiesStopOutsideOfTheGround) {
  for (const double angle : {0.0, 0.6}) {
    BoxScene scene({{}}, {.ground_m = 0});
    scene.place(0, Vec3(0, 1.37, 0), angle);
    scene.setVelocity(0, Vec3(3, -60, 0));
    BodyStepper stepper(*scene.system);
    for (int i = 0; i < 60; ++i) {
      stepper.step(kFrame_s, scene.state);
      ASSERT_GT(scene.lowest_m(), -1e-4) << angle << ' ' << i;
    }
  }
}

// A plate 6 mm thick that a body is shot at.
template <class Plate>
void expectToStop(double speed_m_per_s) {
  Plate plate(SolidDef{"superellipsoid", {1, 0.003, 1, 0.2, 0.2}, {}});
  BoxScene scene({{}}, {});
  scene.contacts->addObstacle(plate);
  scene.place(0, Vec3(0.05, 0.7, 0.1), 0.3);
  scene.setVelocity(0, Vec3(0, -speed_m_per_s, 0));
  BodyStepper stepper(*scene.system);
  double nearest = HUGE_VAL;
  for (int i = 0; i < 30; ++i) {
    stepper.step(kFrame_s, scene.state);
    nearest = std::min(nearest, scene.lowest_m());
  }
  EXPECT_GT(nearest, -1e-3) << speed_m_per_s;
  EXPECT_LT(nearest, 0.01) << speed_m_per_s;
}

TEST(Contact, FastBodiesDoNotPassThroughThinSolids) {
  for (const double speed : {5.0, 30.0, 90.0}) expectToStop<test::MovingSolid>(speed);
}

// Blends of many elements overestimate distances; their Lipschitz bound says by how much.
TEST(Contact, FastBodiesDoNotPassThroughAFieldThatOverestimates) {
  for (const double speed : {5.0, 30.0, 90.0}) expectToStop<test::Steep<test::MovingSolid>>(speed);
}

TEST(Contact, LandsOnASphere) {
  test::MovingSolid sphere(test::sphereDef(0.5));
  sphere.center_m = Vec3(1, -0.5, 2);
  BoxScene scene({{}}, {});
  const ObstacleId id = scene.contacts->addObstacle(sphere);
  scene.place(0, Vec3(1, 0.3, 2));
  BodyStepper stepper(*scene.system);
  advance(stepper, scene, 120);
  EXPECT_NEAR(scene.center(0).y(), 0.5 * kEdge_m, 3 * kMargin_m);
  EXPECT_LT(scene.velocity(0).norm(), 1e-2);
  scene.contacts->removeObstacle(id);
  advance(stepper, scene, 30);
  EXPECT_LT(scene.center(0).y(), -0.5);
}

TEST(Contact, AMovingSolidCarriesABody) {
  test::MovingSolid belt({"superellipsoid", {3, 0.1, 3, 0.1, 0.1}, {}});
  belt.velocity_m_per_s = Vec3(0.6, 0.1, 0);
  belt.center_m.y() = -0.1;
  BoxScene scene({{}}, {.friction = 0.5});
  scene.contacts->addObstacle(belt);
  scene.place(0, Vec3(0, 0.5 * kEdge_m + 2 * kMargin_m, 0));
  BodyStepper stepper(*scene.system);
  double halfWay = 0;
  for (int i = 0; i < 60; ++i) {
    belt.center_m += kFrame_s * belt.velocity_m_per_s;  // to where it is at the step's end
    stepper.step(kFrame_s, scene.state);
    if (i == 2) halfWay = scene.velocity(0).x();
  }
  EXPECT_LT(halfWay, 0.5);  // µ g takes 0.12 s
  EXPECT_NEAR(scene.velocity(0).x(), 0.6, 0.01);
  EXPECT_NEAR(scene.velocity(0).y(), 0.1, 0.01);
  EXPECT_NEAR(scene.center(0).y() - belt.center_m.y(), 0.1 + 0.5 * kEdge_m, 2 * kMargin_m);
}

TEST(Contact, LetsOutGentlyWhatBeginsInside) {
  BoxScene scene({{}}, {.ground_m = 0});
  scene.place(0, Vec3(0, 0.5 * kEdge_m - 0.06, 0));
  BodyStepper stepper(*scene.system);
  double fastest = 0;
  for (int i = 0; i < 60; ++i) {
    stepper.step(kFrame_s, scene.state);
    fastest = std::max(fastest, scene.velocity(0).y());
  }
  EXPECT_LT(fastest, 2 * kEdge_m);  // a size per second, and the margin
  EXPECT_GT(scene.lowest_m(), 0);
}

TEST(Contact, WorksInThePlane) {
  const std::vector<Vec2> square{{-0.1, -0.1}, {0.1, -0.1}, {0.1, 0.1}, {-0.1, 0.1}};
  const BodySurfacePtr surface = makeOutlineSurface(square, 0.1);
  BodyModel model;
  const BodyShapePtr shape =
      test::makeBar(makeAffineBasis(2), {.rigidity_Pa = 1e4, .volume_Pa = 1e4}, {0.2, 0.2, 0}, 10);
  model.add(shape), model.add(shape);
  BodySystem system(std::move(model));
  BodyContacts& contacts = system.setContacts({.ground_m = 0});
  for (int b = 0; b < 2; ++b) contacts.setSurface(BodyId(b), surface);
  OdeState state = system.model().restState();
  system.model().place(BodyId(0), {Mat3::Identity(), Vec3(0, 0.2, 0)}, state);
  system.model().place(BodyId(1), {Mat3::Identity(), Vec3(0.03, 0.5, 0)}, state);
  BodyStepper stepper(system);
  for (int i = 0; i < 180; ++i) stepper.step(kFrame_s, state);
  EXPECT_NEAR(system.model().point(state.r, {BodyId(0), Vec3::Zero()}).y(), 0.1, 2 * kMargin_m);
  EXPECT_NEAR(system.model().point(state.r, {BodyId(1), Vec3::Zero()}).y(), 0.3, 4 * kMargin_m);
}

TEST(Contact, IsRefusedWhereItDoesNotWork) {
  BoxScene scene({{}}, {.ground_m = 0});
  for (const BodyScheme scheme : {BodyScheme::explicitEuler, BodyScheme::energyConserving})
    EXPECT_THROW(BodyStepper(*scene.system, {.scheme = scheme}), Error);
  EXPECT_THROW(scene.system->setContacts({.friction = -1}), Error);
  EXPECT_THROW(scene.contacts->setSurface(BodyId(1), nullptr), Error);
}

}  // namespace
}  // namespace fascia
