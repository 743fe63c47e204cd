#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>
#include <fmt/core.h>

#include <memory>
#include <vector>

#include "bench/peers/peer.h"

namespace fascia {
namespace {

btVector3 toBullet(const Vec3& p) {
  return {static_cast<btScalar>(p.x()), static_cast<btScalar>(p.y()), static_cast<btScalar>(p.z())};
}

btTransform sphereTransform(int sphere, double time_s) {
  btTransform transform;
  transform.setIdentity();
  transform.setOrigin(toBullet(SheetScene::sphereCenter(sphere, time_s)));
  return transform;
}

// Passes over the links in a step; they are as stiff as Bullet allows.
constexpr int kBulletIterations = 4;
constexpr int kBulletDefaultSteps = 5;  // of its world, in a frame

// The position-based soft body.
class BulletSheet final : public SheetSolver {
 public:
  BulletSheet(const SheetScene& scene, int steps)
      : scene_(scene),
        steps_(steps),
        sphereShape_(static_cast<btScalar>(SheetScene::kSphereRadius_m)) {
    const btVector3 gravity = toBullet({0, -SheetScene::kGravity_m_per_s2, 0});
    world_.setGravity(gravity);
    btSoftBodyWorldInfo& info = world_.getWorldInfo();
    info.m_gravity = gravity;
    info.m_broadphase = &broadphase_;
    info.m_dispatcher = &dispatcher_;
    info.air_density = 0;
    constexpr btScalar kDistanceVoxel_m = 0.05f;
    info.m_sparsesdf.setDefaultVoxelsz(kDistanceVoxel_m);
    info.m_sparsesdf.Initialize();
    addSpheres();
    addSheet(info);
  }

  ~BulletSheet() override {
    world_.removeSoftBody(sheet_.get());
    for (const auto& body : spheres_) world_.removeRigidBody(body.get());
  }
  BulletSheet(const BulletSheet&) = delete;
  BulletSheet& operator=(const BulletSheet&) = delete;

  void advanceFrame() override {
    const double step_s = SheetScene::kFrame_s / steps_;
    for (int s = 0; s < steps_; ++s) {
      time_s_ += step_s;
      for (std::size_t i = 0; i < spheres_.size(); ++i)
        states_[i]->setWorldTransform(sphereTransform(static_cast<int>(i), time_s_));
      world_.stepSimulation(static_cast<btScalar>(step_s), 1, static_cast<btScalar>(step_s));
    }
  }

  Vec3 position(int i, int j) const override {
    const btVector3& p = sheet_->m_nodes[i + j * scene_.side].m_x;
    return {p.x(), p.y(), p.z()};
  }

 private:
  void addSpheres() {
    for (int s = 0; s < SheetScene::kSpheres; ++s) {
      states_.push_back(std::make_unique<btDefaultMotionState>(sphereTransform(s, 0)));
      const btRigidBody::btRigidBodyConstructionInfo info(0, states_.back().get(), &sphereShape_);
      auto body = std::make_unique<btRigidBody>(info);
      body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
      body->setActivationState(DISABLE_DEACTIVATION);
      world_.addRigidBody(body.get());
      spheres_.push_back(std::move(body));
    }
  }

  void addSheet(btSoftBodyWorldInfo& info) {
    const btScalar half = SheetScene::kSide_m / 2;
    sheet_.reset(btSoftBodyHelpers::CreatePatch(
        info, btVector3(-half, 0, -half), btVector3(half, 0, -half), btVector3(-half, 0, half),
        btVector3(half, 0, half), scene_.side, scene_.side, 0, true));
    constexpr btScalar kCollisionMargin_m = 0.01f;
    sheet_->getCollisionShape()->setMargin(kCollisionMargin_m);
    sheet_->m_materials[0]->m_kLST = 1;
    sheet_->m_cfg.piterations = kBulletIterations;
    sheet_->m_cfg.kDP = 0.001f;  // damping
    sheet_->m_cfg.kDF = 0.5f;    // friction
    sheet_->m_cfg.kCHR = 1;      // hardness of contacts
    sheet_->m_cfg.kKHR = 1;      // and of those with moving bodies
    sheet_->m_cfg.collisions = btSoftBody::fCollision::SDF_RS;
    sheet_->setTotalMass(SheetScene::kMass_kg, false);
    for (int j = 0; j < scene_.side; ++j) {
      for (int i = 0; i < scene_.side; ++i) {
        const int node = i + j * scene_.side;
        if (scene_.pinned(j)) sheet_->setMass(node, 0);
        sheet_->m_nodes[node].m_x = sheet_->m_nodes[node].m_q = toBullet(scene_.start(i, j));
      }
    }
    sheet_->randomizeConstraints();  // converges faster than in the order of the grid
    sheet_->setActivationState(DISABLE_DEACTIVATION);
    world_.addSoftBody(sheet_.get());
  }

  SheetScene scene_;
  int steps_;
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btSoftRigidDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  btSphereShape sphereShape_;
  std::vector<std::unique_ptr<btDefaultMotionState>> states_;
  std::vector<std::unique_ptr<btRigidBody>> spheres_;
  std::unique_ptr<btSoftBody> sheet_;
  double time_s_ = 0;
};

}  // namespace

const Peer kBulletPeer{
    "Bullet",
    [](int effort) {
      return fmt::format("{} x {}", effort * kBulletDefaultSteps, kBulletIterations);
    },
    [](const SheetScene& scene, int effort, int) -> std::unique_ptr<SheetSolver> {
      return std::make_unique<BulletSheet>(scene, effort * kBulletDefaultSteps);
    },
    false};

}  // namespace fascia
