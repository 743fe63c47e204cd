#include "deformable/bullet_chains.h"

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <memory>
#include <vector>

namespace fascia {
namespace {

constexpr btScalar kMass_kg = 2, kHalf_m = 0.1f, kHalfWidth_m = 0.05f, kGap_m = 0.2f;
constexpr btScalar kStep_s = 1.0f / 600;

btVector3 barInertia() {
  const btBoxShape box(btVector3(kHalf_m, kHalfWidth_m, kHalfWidth_m));
  btVector3 inertia;
  box.calculateLocalInertia(kMass_kg, inertia);
  return inertia;
}

// Everything but the bodies: no collisions are asked for.
struct Surroundings {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
};

template <class World>
double secondsPerSecond(World& world) {
  world.stepSimulation(kStep_s, 1, kStep_s);
  const std::clock_t begin = std::clock();
  for (int i = 0; i < 600; ++i) world.stepSimulation(kStep_s, 1, kStep_s);
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

void print(const char* name, double cost, double stretch) {
  std::printf("%-48s %12.4f %12.2f   longest gap %.2g m\n", name, cost, 1 / cost, stretch);
  std::fflush(stdout);
}

double runMultibodies(int chains, int bars) {
  Surroundings around;
  btMultiBodyConstraintSolver solver;
  btMultiBodyDynamicsWorld world(&around.dispatcher, &around.broadphase, &solver,
                                 &around.configuration);
  world.setGravity(btVector3(0, -9.81f, 0));
  std::vector<std::unique_ptr<btMultiBody>> bodies;
  for (int c = 0; c < chains; ++c) {
    auto body = std::make_unique<btMultiBody>(bars, btScalar(0), btVector3(0, 0, 0), true, false);
    body->setBasePos(btVector3(0, 0, kGap_m * static_cast<btScalar>(c)));
    for (int i = 0; i < bars; ++i)
      body->setupSpherical(i, kMass_kg, barInertia(), i - 1, btQuaternion::getIdentity(),
                           btVector3(i == 0 ? 0 : kHalf_m, 0, 0), btVector3(kHalf_m, 0, 0), true);
    body->finalizeMultiDof();
    body->setLinearDamping(0), body->setAngularDamping(0);
    world.addMultiBody(body.get());
    bodies.push_back(std::move(body));
  }
  const double cost = secondsPerSecond(world);
  for (const auto& body : bodies) world.removeMultiBody(body.get());
  return cost;
}

// A row of rigid bars whose ends are tied by Bullet's iterative solver.
double runRigidBodies(int chains, int bars, int iterations, double& gap_m) {
  Surroundings around;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&around.dispatcher, &around.broadphase, &solver,
                                &around.configuration);
  world.setGravity(btVector3(0, -9.81f, 0));
  world.getSolverInfo().m_numIterations = iterations;
  btBoxShape box(btVector3(kHalf_m, kHalfWidth_m, kHalfWidth_m));
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  std::vector<std::unique_ptr<btPoint2PointConstraint>> ties;
  for (int c = 0; c < chains; ++c) {
    for (int i = 0; i < bars; ++i) {
      bodies.push_back(std::make_unique<btRigidBody>(
          btRigidBody::btRigidBodyConstructionInfo(kMass_kg, nullptr, &box, barInertia())));
      btTransform place;
      place.setIdentity();
      place.setOrigin(btVector3(kHalf_m * static_cast<btScalar>(2 * i + 1), 0,
                                kGap_m * static_cast<btScalar>(c)));
      bodies.back()->setWorldTransform(place);
      bodies.back()->setActivationState(DISABLE_DEACTIVATION);
      world.addRigidBody(bodies.back().get(), 0, 0);
      const btVector3 end(kHalf_m, 0, 0);
      ties.push_back(i == 0 ? std::make_unique<btPoint2PointConstraint>(*bodies.back(), -end)
                            : std::make_unique<btPoint2PointConstraint>(*bodies[bodies.size() - 2],
                                                                        *bodies.back(), end, -end));
      world.addConstraint(ties.back().get(), true);
    }
  }
  const double cost = secondsPerSecond(world);
  gap_m = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (i % static_cast<std::size_t>(bars) == 0) continue;
    const btVector3 a = bodies[i - 1]->getWorldTransform() * btVector3(kHalf_m, 0, 0);
    const btVector3 b = bodies[i]->getWorldTransform() * btVector3(-kHalf_m, 0, 0);
    gap_m = std::max(gap_m, static_cast<double>(a.distance(b)));
  }
  for (const auto& tie : ties) world.removeConstraint(tie.get());
  for (const auto& body : bodies) world.removeRigidBody(body.get());
  return cost;
}

// A bar as a soft body: its corners, all tied to each other by links, in one cluster.
std::unique_ptr<btSoftBody> makeSoftBar(btSoftBodyWorldInfo& info, const btVector3& center) {
  btVector3 corners[8];
  btScalar masses[8];
  for (int i = 0; i < 8; ++i) {
    corners[i] =
        center + btVector3(i & 1 ? kHalf_m : -kHalf_m, i & 2 ? kHalfWidth_m : -kHalfWidth_m,
                           i & 4 ? kHalfWidth_m : -kHalfWidth_m);
    masses[i] = kMass_kg / 8;
  }
  auto bar = std::make_unique<btSoftBody>(&info, 8, corners, masses);
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < i; ++j) bar->appendLink(i, j);
  bar->m_cfg.collisions = 0;
  bar->generateClusters(1);
  return bar;
}

// Soft bars whose clusters are tied by linear joints.
double runSoftBodies(int chains, int bars, double& gap_m) {
  Surroundings around;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world(&around.dispatcher, &around.broadphase, &solver,
                                 &around.configuration);
  const btVector3 gravity(0, -9.81f, 0);
  world.setGravity(gravity);
  btSoftBodyWorldInfo& info = world.getWorldInfo();
  info.m_gravity = gravity, info.air_density = 0;
  info.m_broadphase = &around.broadphase, info.m_dispatcher = &around.dispatcher;
  std::vector<std::unique_ptr<btSoftBody>> bodies;
  for (int c = 0; c < chains; ++c) {
    for (int i = 0; i < bars; ++i) {
      const btVector3 center(kHalf_m * static_cast<btScalar>(2 * i + 1), 0,
                             kGap_m * static_cast<btScalar>(c));
      bodies.push_back(makeSoftBar(info, center));
      world.addSoftBody(bodies.back().get(), 0, 0);
      btSoftBody::LJoint::Specs joint;
      joint.position = center - btVector3(kHalf_m, 0, 0);
      if (i == 0)
        bodies.back()->appendLinearJoint(joint, btSoftBody::Body());
      else
        bodies.back()->appendLinearJoint(joint, bodies[bodies.size() - 2].get());
    }
  }
  const double cost = secondsPerSecond(world);
  gap_m = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (i % static_cast<std::size_t>(bars) == 0) continue;
    btVector3 ends[2] = {btVector3(0, 0, 0), btVector3(0, 0, 0)};
    for (int corner = 0; corner < 8; ++corner) {
      if (corner & 1) ends[0] += bodies[i - 1]->m_nodes[corner].m_x / 4;
      if (!(corner & 1)) ends[1] += bodies[i]->m_nodes[corner].m_x / 4;
    }
    gap_m = std::max(gap_m, static_cast<double>(ends[0].distance(ends[1])));
  }
  for (const auto& body : bodies) world.removeSoftBody(body.get());
  return cost;
}

}  // namespace

void printBulletChains(int chains, int bars) {
  print("Bullet multibodies (rigid), 60 Hz x 10", runMultibodies(chains, bars), 0);
  for (const int iterations : {10, 50}) {
    double gap_m = 0;
    const double cost = runRigidBodies(chains, bars, iterations, gap_m);
    char name[64];
    std::snprintf(name, sizeof name, "Bullet rigid bodies, %d iterations, 60 Hz x 10", iterations);
    print(name, cost, gap_m);
  }
  double gap_m = 0;
  const double cost = runSoftBodies(chains, bars, gap_m);
  print("Bullet soft-body clusters, 60 Hz x 10", cost, gap_m);
}

}  // namespace fascia
