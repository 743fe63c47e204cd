#include <gtest/gtest.h>

#include <fascia/base/hash.h>
#include <fascia/base/parallel.h>

#include "contact_scenes.h"
#include "scenes.h"

// Bodies against each other.

namespace fascia {
namespace {

using test::BoxKind;
using test::BoxScene;
using test::kFrame_s;

constexpr double kBoxEdge_m = 0.2;

void stack(BoxScene& scene) {
  double top = 0.001;
  for (std::size_t i = 0; i < scene.edges_m.size(); ++i) {
    scene.place(static_cast<int>(i), Vec3(0, top + 0.5 * scene.edges_m[i], 0));
    top += scene.edges_m[i] + 0.001;
  }
}

std::uint64_t hashOf(const OdeState& state) {
  StateHash hash;
  for (const double x : state.r) hash.add(x);
  for (const double x : state.v) hash.add(x);
  return hash.value();
}

TEST(BodyContact, CollisionsKeepMomentum) {
  BoxScene scene({{}, {.density_kg_per_m3 = 500}}, {.friction = 0.6}, Vec3::Zero());
  scene.place(0, Vec3(-0.3, 0, 0), 0.4), scene.place(1, Vec3(0.1, 0.05, 0.02), 1.1);
  scene.setVelocity(0, Vec3(2, 0.1, 0)), scene.setVelocity(1, Vec3(-1, 0, 0.2));
  const BodyModel& model = scene.system->model();
  const Vec3 linear = model.momentum_Ns(scene.state.v);
  const double relative = (scene.velocity(0) - scene.velocity(1)).norm();
  BodyStepper stepper(*scene.system,
                      {.contact_tolerance = 1e-13, .contact_patience = 300, .max_iterations = 300});
  advance(stepper, scene, 40);
  EXPECT_LT((model.momentum_Ns(scene.state.v) - linear).norm(), 1e-10 * linear.norm());
  EXPECT_LT((scene.velocity(0) - scene.velocity(1)).norm(), 0.8 * relative);  // they met
}

TEST(BodyContact, AStackOfFiveStays) {
  BoxScene scene(std::vector<BoxKind>(5), {.ground_m = 0});
  stack(scene);
  BodyStepper stepper(*scene.system);
  advance(stepper, scene, 120);
  const Vec3 settled = scene.center(4);
  advance(stepper, scene, 480);
  EXPECT_LT((scene.center(4) - settled).norm(), 1e-3);
  EXPECT_LT(scene.velocity(4).norm(), 1e-4);
  EXPECT_GT(scene.lowest_m(), 0);
  EXPECT_EQ(stepper.stats().halved, 0u);
  EXPECT_EQ(stepper.stats().stopped, 0u);
}

TEST(BodyContact, AHeavyBoxRestsOnALightOne) {
  const BodyMaterial steel{.rigidity_Pa = 1e9, .volume_Pa = 1e9};
  BoxScene scene(
      {{.material = steel, .density_kg_per_m3 = 10}, {.material = steel, .density_kg_per_m3 = 1e5}},
      {.ground_m = 0});
  stack(scene);
  BodyStepper stepper(*scene.system);
  advance(stepper, scene, 240);
  EXPECT_GT(scene.lowest_m(), 0);
  EXPECT_NEAR(scene.center(1).y(), 1.5 * kBoxEdge_m, 0.02 * kBoxEdge_m);
  EXPECT_LT(scene.velocity(1).norm(), 1e-3);
}

TEST(BodyContact, JellyAndSteelFallOntoEachOther) {
  for (const bool steelOnTop : {false, true}) {
    BoxKind steel{.material = {.rigidity_Pa = 1e9, .volume_Pa = 1e9}},
        jelly{.material = {.rigidity_Pa = 1e3, .volume_Pa = 1e3}, .density_kg_per_m3 = 300};
    if (steelOnTop) steel.density_kg_per_m3 = 100;  // that the jelly can carry
    BoxScene scene(steelOnTop ? std::vector{jelly, steel} : std::vector{steel, jelly},
                   {.ground_m = 0});
    scene.place(0, Vec3(0, 0.15, 0)), scene.place(1, Vec3(0.02, 0.6, 0.01), 0.2);
    BodyStepper stepper(*scene.system);
    for (int i = 0; i < 180; ++i) {
      stepper.step(kFrame_s, scene.state);
      ASSERT_GT(scene.lowest_m(), -1e-3) << steelOnTop << ' ' << i;
      ASSERT_LT(scene.state.r.empty() ? 1 : scene.center(1).norm(), 3);
    }
    EXPECT_EQ(stepper.stats().stopped, 0u);
    EXPECT_GT(scene.center(1).y(), 0.05);
  }
}

TEST(BodyContact, FastBodiesDoNotPassThroughEachOther) {
  // 0.5 m in a step, more than twice their size; firm, or they would turn inside out.
  const BoxKind firm{.material = {.rigidity_Pa = 1e7, .volume_Pa = 1e7}};
  BoxScene scene({firm, firm}, {}, Vec3::Zero());
  scene.place(0, Vec3(-0.61, 0, 0)), scene.place(1, Vec3(0.57, 0.03, 0.02), 0.2);
  scene.setVelocity(0, Vec3(15, 0, 0)), scene.setVelocity(1, Vec3(-15, 0, 0));
  const BodySurfacePtr box = makeMeshSurface(test::boxMesh(Vec3::Constant(kBoxEdge_m)));
  BodyField field(scene.system->model(), std::vector{box, box});
  BodyStepper stepper(*scene.system);
  float nearest = 1;
  for (int i = 0; i < 10; ++i) {
    stepper.step(kFrame_s, scene.state);
    field.update(scene.state.r, scene.state.v);
    for (const Eigen::Vector3f& X : box->mesh().positions) {
      const Vec3 x = scene.system->model().point(scene.state.r, {BodyId(0), X.cast<double>()});
      const Eigen::Vector3f p = x.cast<float>();
      float distance_m, nx, ny, nz;
      field.evaluate(SolidId(1), {&p.x(), &p.y(), &p.z(), 1}, &distance_m, {&nx, &ny, &nz, 1});
      nearest = std::min(nearest, distance_m);
    }
  }
  EXPECT_GT(nearest, -1e-4);
  EXPECT_LT(nearest, 0.01);
  EXPECT_LT(scene.velocity(0).x(), 2);  // they glance off each other
}

TEST(BodyContact, BodiesThatAreTiedDoNotCollide) {
  BoxScene scene({{}, {}}, {}, Vec3::Zero());
  scene.place(0, Vec3(0, 0, 0)), scene.place(1, Vec3(0.15, 0, 0));
  const Vec3 end(0.075, 0, 0);
  const ConstraintId tie =
      scene.system->hold(makeAttachment("tie", {BodyId(0), end}, {BodyId(1), -end}));
  BodyStepper stepper(*scene.system);
  advance(stepper, scene, 10);
  EXPECT_NEAR(scene.center(1).x(), 0.15, 1e-9);
  scene.system->release(tie);
  scene.contacts->ignorePair(BodyId(1), BodyId(0));
  advance(stepper, scene, 10);
  EXPECT_NEAR(scene.center(1).x(), 0.15, 1e-9);
  scene.contacts->collidePair(BodyId(0), BodyId(1));
  advance(stepper, scene, 60);
  EXPECT_GT(scene.center(1).x() - scene.center(0).x(), kBoxEdge_m);
}

TEST(BodyContact, KeepsConstraintsWhileBodiesTouch) {
  BoxScene scene(std::vector<BoxKind>(3), {.ground_m = 0});
  stack(scene);
  const Vec3 side(0.1, 0.1, 0);
  scene.system->hold(makeNail("nail", {BodyId(1), side}, scene.center(1) + side));
  scene.system->pull({makeNail("spring", {BodyId(2), -side}, Vec3(-0.3, 0.4, 0)), 100, 1});
  BodyStepper stepper(*scene.system);
  for (int i = 0; i < 120; ++i) {
    stepper.step(kFrame_s, scene.state);
    ASSERT_LT(scene.system->drift_m(scene.state), 1e-10);
  }
  EXPECT_GT(scene.lowest_m(), 0);
  EXPECT_EQ(stepper.stats().stopped, 0u);
}

TEST(BodyContact, GivesTheSameBitsOnAnyNumberOfThreads) {
  std::vector<std::uint64_t> hashes;
  for (const int threads : {1, 2, 8}) {
    const ThreadLimit limit(threads);
    BoxScene scene(std::vector<BoxKind>(24), {.ground_m = 0, .points_per_body = 30});
    for (int i = 0; i < 24; ++i)
      scene.place(i, Vec3(0.25 * (i % 3), 0.2 + 0.3 * (i / 6), 0.25 * (i / 3 % 2)), 0.3 * i);
    BodyStepper stepper(*scene.system);
    advance(stepper, scene, 40);
    EXPECT_TRUE(scene.contacts->contacts().hasPairs());
    hashes.push_back(hashOf(scene.state));
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

TEST(BodyContact, ChangesNothingWhereNothingTouches) {
  std::vector<std::uint64_t> hashes;
  for (const bool withContacts : {false, true}) {
    OdeState state;
    const auto system = test::makeChain(4, state, {.rigidity_Pa = 5e3, .volume_Pa = 1e4});
    if (withContacts) {
      BodyContacts& contacts = system->setContacts({.ground_m = -100});
      const BodySurfacePtr surface = makeMeshSurface(test::boxMesh(test::kLinkSize_m));
      for (int b = 0; b < 4; b += 2) contacts.setSurface(BodyId(b), surface);
    }
    BodyStepper stepper(*system);
    for (int i = 0; i < 30; ++i) stepper.step(kFrame_s, state);
    hashes.push_back(hashOf(state));
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

}  // namespace
}  // namespace fascia
