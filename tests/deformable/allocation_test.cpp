#include <gtest/gtest.h>

#include <fascia/base/parallel.h>
#include <fascia/deformable/body/body_field.h>

#include "contact_scenes.h"
#include "puppets.h"
#include "scenes.h"
#include "support/count_allocations.h"

namespace fascia {
namespace {

TEST(BodyStepper, AllocatesOnlyWhenConstraintsChange) {
  const ThreadLimit one(1);
  for (const BodyScheme scheme :
       {BodyScheme::explicitEuler, BodyScheme::implicitEuler, BodyScheme::energyConserving}) {
    OdeState state;
    const auto system = test::makeChain(
        4, state, {.rigidity_Pa = 5e3, .relaxation_s = 1e-3, .power_damping_s_per_J = 0.01});
    system->hold(makeNail("again", {BodyId(0), test::linkEnd(-1)}, Vec3::Zero()));
    system->hold(makeTether("tether", {BodyId(2), test::linkEnd(1)}, Vec3(0.6, 0.3, 0), 0.3));
    system->pull({makeNail("spring", {BodyId(3), test::linkEnd(1)}, Vec3(0.8, 0, 0.1)), 50, 1});
    BodyStepper stepper(*system, {.scheme = scheme});
    for (int i = 0; i < 3; ++i) stepper.step(1e-3, state);
    const long before = allocations;
    for (int i = 0; i < 20; ++i) stepper.step(1e-3, state);
    EXPECT_EQ(allocations - before, 0) << static_cast<int>(scheme);
    system->hold(makeNail("end", {BodyId(3), test::linkEnd(1)},
                          system->model().point(state.r, {BodyId(3), test::linkEnd(1)})));
    stepper.step(1e-3, state);
    EXPECT_GT(allocations - before, 0);
  }
}

TEST(BodyField, AllocatesNothingAfterConstruction) {
  Diagnostics diagnostics;
  const Solid sphere({"sphere", {0.05}, {}}, "", diagnostics);
  for (const BasisPtr& basis :
       {makeAffineBasis(3), makePolynomialBasis(3, 4, test::boxOf(test::kBarSize_m))}) {
    BodyModel model;
    model.add(test::makeBar(basis));
    const OdeState state = model.restState();
    BodyField field(model, std::vector<BodySurfacePtr>{makeSolidSurface(sphere, 12)});
    const long before = allocations;
    field.update(state.r, state.v);
    for (const float x : {0.02f, 5.0f}) {
      const float y = 0.01f, z = 0;
      Eigen::Vector3f n;
      float d = 0;
      field.evaluate(SolidId(0), {&x, &y, &z, 1}, &d, {&n.x(), &n.y(), &n.z(), 1});
      field.velocity(SolidId(0), {&x, &y, &z, 1}, {&n.x(), &n.y(), &n.z(), 1});
      field.materialFromWorld(SolidId(0), Vec3(x, y, z));
    }
    EXPECT_EQ(allocations - before, 0) << basis->name();
  }
}

TEST(Puppet, AllocatesOnlyWhenAControlBeginsOrEnds) {
  const ThreadLimit one(1);
  test::PuppetStage stage(3, 2);
  Puppet& puppet = *stage.puppet;
  puppet.run(makeChase(stage["right 0"], stage["left 1"], {.duration_s = 10}));
  const KeyframedPath path({{0, Vec3(1, 0, 0), {}, {}},
                            {0.2, Vec3(1, 1, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)},
                            {9, Vec3(2, 1, 0), {}, {}}});
  puppet.run(makeFollow(stage["right 1"], path, {.preroll_s = 0.1}));
  puppet.run(makeWaitFor([](const Puppet&) { return false; }));
  puppet.push(stage["middle 0"], Vec3(1, 0, 0), 10);
  const auto pullTo = [&](double x) { puppet.pull(stage["left 0"], Vec3(x, 0, 0), 50, 5); };
  pullTo(0);
  for (int i = 0; i < 3; ++i) stage.step();
  const long before = allocations;
  for (int i = 0; i < 60; ++i) pullTo(0.01 * i), stage.step();
  EXPECT_EQ(allocations - before, 0);
  puppet.hold(stage["left 0"]);
  EXPECT_GT(allocations - before, 0);
}

TEST(BodyStepper, AllocatesNothingForContactsThatStay) {
  const ThreadLimit one(1);
  test::BoxScene scene(std::vector<test::BoxKind>(4), {.ground_m = 0});
  test::MovingSolid sphere(test::sphereDef(0.5));
  sphere.center_m = Vec3(0.9, 0.8, 0);
  scene.contacts->addObstacle(sphere);
  for (int i = 0; i < 4; ++i) scene.place(i, Vec3(0, 0.102 + 0.202 * i, 0));
  BodyStepper stepper(*scene.system);
  for (int i = 0; i < 20; ++i) stepper.step(test::kFrame_s, scene.state);
  const long before = allocations;
  for (int i = 0; i < 20; ++i) stepper.step(test::kFrame_s, scene.state);
  EXPECT_EQ(allocations - before, 0);
  EXPECT_TRUE(scene.contacts->contacts().hasPairs());
}

}  // namespace
}  // namespace fascia
