#include <Jolt/Jolt.h>

#include <Jolt/Core/Factory.h>
#include <Jolt/Core/JobSystemThreadPool.h>
#include <Jolt/Core/TempAllocator.h>
#include <Jolt/Physics/Body/BodyCreationSettings.h>
#include <Jolt/Physics/Collision/BroadPhase/BroadPhaseLayerInterfaceTable.h>
#include <Jolt/Physics/Collision/BroadPhase/ObjectVsBroadPhaseLayerFilterTable.h>
#include <Jolt/Physics/Collision/ObjectLayerPairFilterTable.h>
#include <Jolt/Physics/Collision/Shape/SphereShape.h>
#include <Jolt/Physics/PhysicsSystem.h>
#include <Jolt/Physics/SoftBody/SoftBodyCreationSettings.h>
#include <Jolt/Physics/SoftBody/SoftBodyMotionProperties.h>
#include <Jolt/RegisterTypes.h>
#include <fmt/core.h>

#include <memory>
#include <vector>

#include "bench/peers/peer.h"

namespace fascia {
namespace {

constexpr int kJoltDefaultIterations = 5;  // steps of its soft bodies in a frame
constexpr JPH::ObjectLayer kSpheresLayer = 0, kSheetLayer = 1;
constexpr JPH::uint kLayers = 2;
constexpr JPH::uint kScratch_bytes = 64u << 20;

JPH::RVec3 toJolt(const Vec3& p) {
  return {static_cast<JPH::Real>(p.x()), static_cast<JPH::Real>(p.y()),
          static_cast<JPH::Real>(p.z())};
}

// What its programs do once, before all else.
struct JoltLibrary {
  JoltLibrary() {
    JPH::RegisterDefaultAllocator();
    JPH::Factory::sInstance = new JPH::Factory();
    JPH::RegisterTypes();
  }
  ~JoltLibrary() {
    JPH::UnregisterTypes();
    delete JPH::Factory::sInstance;
    JPH::Factory::sInstance = nullptr;
  }
  JoltLibrary(const JoltLibrary&) = delete;
  JoltLibrary& operator=(const JoltLibrary&) = delete;
};

// Spheres touch the sheet and nothing else touches anything.
class JoltLayers {
 public:
  JoltLayers() : broad_(kLayers, kLayers), pairs_(kLayers) {
    broad_.MapObjectToBroadPhaseLayer(kSpheresLayer, JPH::BroadPhaseLayer(0));
    broad_.MapObjectToBroadPhaseLayer(kSheetLayer, JPH::BroadPhaseLayer(1));
    pairs_.EnableCollision(kSpheresLayer, kSheetLayer);
    // Reads the others' tables.
    pairsInBroad_ =
        std::make_unique<JPH::ObjectVsBroadPhaseLayerFilterTable>(broad_, kLayers, pairs_, kLayers);
  }
  void init(JPH::PhysicsSystem& world) const {
    constexpr JPH::uint kBodies = 64;
    world.Init(kBodies, 0, kBodies, kBodies, broad_, *pairsInBroad_, pairs_);
  }

 private:
  JPH::BroadPhaseLayerInterfaceTable broad_;
  JPH::ObjectLayerPairFilterTable pairs_;
  std::unique_ptr<JPH::ObjectVsBroadPhaseLayerFilterTable> pairsInBroad_;
};

// The soft body of extended position-based dynamics: edges without compliance, shear as soft as our
// cloth's, and attachments over the whole way from the pinned edges, as its manual advises.
class JoltSheet final : public SheetSolver {
 public:
  JoltSheet(const SheetScene& scene, int iterations, int threads)
      : scene_(scene), jobs_(JPH::cMaxPhysicsJobs, JPH::cMaxPhysicsBarriers, threads - 1) {
    layers_.init(world_);
    world_.SetGravity({0, static_cast<float>(-SheetScene::kGravity_m_per_s2), 0});
    addSpheres();
    addSheet(iterations);
    world_.OptimizeBroadPhase();
  }

  void advanceFrame() override {
    constexpr auto kFrame_s = static_cast<float>(SheetScene::kFrame_s);
    time_s_ += SheetScene::kFrame_s;
    for (int s = 0; s < SheetScene::kSpheres; ++s)
      bodies().MoveKinematic(spheres_[static_cast<std::size_t>(s)],
                             toJolt(SheetScene::sphereCenter(s, time_s_)), JPH::Quat::sIdentity(),
                             kFrame_s);
    world_.Update(kFrame_s, 1, &scratch_, &jobs_);
  }

  Vec3 position(int i, int j) const override {
    const JPH::Vec3 p = motion_->GetVertex(index(i, j)).mPosition;
    return {p.GetX(), p.GetY(), p.GetZ()};
  }

 private:
  JPH::BodyInterface& bodies() { return world_.GetBodyInterfaceNoLock(); }
  JPH::uint index(int i, int j) const { return static_cast<JPH::uint>(i + j * scene_.side); }

  void addSpheres() {
    const JPH::RefConst<JPH::Shape> shape =
        new JPH::SphereShape(static_cast<float>(SheetScene::kSphereRadius_m));
    for (int s = 0; s < SheetScene::kSpheres; ++s) {
      const JPH::BodyCreationSettings settings(shape, toJolt(SheetScene::sphereCenter(s, 0)),
                                               JPH::Quat::sIdentity(), JPH::EMotionType::Kinematic,
                                               kSpheresLayer);
      spheres_.push_back(bodies().CreateAndAddBody(settings, JPH::EActivation::Activate));
    }
  }

  JPH::Ref<JPH::SoftBodySharedSettings> makeCloth() const {
    JPH::Ref<JPH::SoftBodySharedSettings> cloth = new JPH::SoftBodySharedSettings;
    const auto points = static_cast<float>(scene_.side * scene_.side);
    const auto inverseMass_per_kg = points / static_cast<float>(SheetScene::kMass_kg);
    // As if flat: rest lengths come from where points are now.
    for (int j = 0; j < scene_.side; ++j)
      for (int i = 0; i < scene_.side; ++i)
        cloth->mVertices.emplace_back(JPH::Float3(static_cast<float>(i * scene_.spacing_m()), 0,
                                                  static_cast<float>(j * scene_.spacing_m())),
                                      JPH::Float3(0, 0, 0),
                                      scene_.pinned(j) ? 0 : inverseMass_per_kg);
    for (int j = 0; j + 1 < scene_.side; ++j)
      for (int i = 0; i + 1 < scene_.side; ++i) {
        cloth->AddFace({index(i, j), index(i, j + 1), index(i + 1, j + 1)});
        cloth->AddFace({index(i, j), index(i + 1, j + 1), index(i + 1, j)});
      }
    constexpr float kShearCompliance_m_per_N = 0.05f;
    const JPH::SoftBodySharedSettings::VertexAttributes attributes(
        0, kShearCompliance_m_per_N, FLT_MAX,
        JPH::SoftBodySharedSettings::ELRAType::GeodesicDistance);
    cloth->CreateConstraints(&attributes, 1, JPH::SoftBodySharedSettings::EBendType::None);
    for (int j = 0; j < scene_.side; ++j)
      for (int i = 0; i < scene_.side; ++i)
        toJolt(scene_.start(i, j)).StoreFloat3(&cloth->mVertices[index(i, j)].mPosition);
    cloth->Optimize();
    return cloth;
  }

  void addSheet(int iterations) {
    JPH::SoftBodyCreationSettings settings(makeCloth(), JPH::RVec3::sZero(), JPH::Quat::sIdentity(),
                                           kSheetLayer);
    settings.mNumIterations = static_cast<JPH::uint32>(iterations);
    settings.mLinearDamping = 0;
    settings.mFriction = 0.5f;
    settings.mUpdatePosition = false;
    settings.mAllowSleeping = false;
    const JPH::Body* body = bodies().CreateSoftBody(settings);
    bodies().AddBody(body->GetID(), JPH::EActivation::Activate);
    motion_ = static_cast<const JPH::SoftBodyMotionProperties*>(body->GetMotionProperties());
  }

  SheetScene scene_;
  JoltLibrary library_;
  JoltLayers layers_;
  JPH::TempAllocatorImplWithMallocFallback scratch_{kScratch_bytes};
  JPH::JobSystemThreadPool jobs_;
  JPH::PhysicsSystem world_;
  std::vector<JPH::BodyID> spheres_;
  const JPH::SoftBodyMotionProperties* motion_ = nullptr;
  double time_s_ = 0;
};

}  // namespace

const Peer kJoltPeer{
    "Jolt", [](int effort) { return fmt::format("{} steps", effort * kJoltDefaultIterations); },
    [](const SheetScene& scene, int effort, int threads) -> std::unique_ptr<SheetSolver> {
      return std::make_unique<JoltSheet>(scene, effort * kJoltDefaultIterations, threads);
    },
    true};

}  // namespace fascia
