#include "bench/sheet/fascia_sheet.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fascia/base/error.h>
#include <fascia/field/field.h>
#include <fascia/field/solid.h>
#include <fascia/math/points.h>
#include <fascia/skin/cloth/cloth_stepper.h>
#include <fascia/skin/contact/flesh_contact.h>
#include <fascia/skin/grid/grid_topology.h>
#include <fascia/skin/point/leapfrog.h>

namespace fascia {
namespace {

// Contact is renewed this often within a frame of the leapfrog, whose steps are as long as adding
// this share to the mass allows, as in skins. Large sheets do not ride on coarse ones, as skins do:
// what keeps a fine grid on its carrier is the tissue, and the sheet has none.
constexpr int kIntervalsPerFrame = 2;
constexpr double kAddedMassShare = 0.02;
constexpr double kDrag_per_s = 0.5;

class Spheres final : public Field {
 public:
  Spheres() {
    Diagnostics diagnostics;
    sphere_ = Solid(SolidDef{"sphere", {SheetScene::kSphereRadius_m}, {}}, "", diagnostics);
    diagnostics.throwIfErrors();
  }
  void moveTo(double time_s) {
    for (std::size_t s = 0; s < kCount; ++s) {
      frame_[s].translation_m = SheetScene::sphereCenter(static_cast<int>(s), time_s);
      velocity_[s] = SheetScene::sphereVelocity(static_cast<int>(s), time_s);
    }
  }

  std::size_t solidCount() const override { return kCount; }
  Box bounds(SolidId solid) const override {
    const Vec3 center = frame_[solid.index()].translation_m;
    const Vec3 half = Vec3::Constant(SheetScene::kSphereRadius_m);
    return {center - half, center + half};
  }
  void evaluate(SolidId solid, ConstVectors points, float* distance_m,
                Vectors normal) const override {
    evaluatePosed(sphere_, frame_[solid.index()], points, distance_m, normal);
  }
  Transform frame(SolidId solid) const override { return frame_[solid.index()]; }
  const Outline& outline(SolidId) const override { return sphere_.outline_m(); }
  void velocity(SolidId solid, ConstVectors, Vectors velocity) const override {
    const Vec3& v = velocity_[solid.index()];
    for (std::size_t i = 0; i < velocity.count; ++i) {
      velocity.x[i] = static_cast<float>(v.x());
      velocity.y[i] = static_cast<float>(v.y());
      velocity.z[i] = static_cast<float>(v.z());
    }
  }
  Vec3 materialFromWorld(SolidId solid, const Vec3& world) const override {
    return world - frame_[solid.index()].translation_m;
  }
  Vec3 worldFromMaterial(SolidId solid, const Vec3& material) const override {
    return material + frame_[solid.index()].translation_m;
  }

 private:
  static constexpr std::size_t kCount = SheetScene::kSpheres;
  Solid sphere_;
  std::array<Transform, kCount> frame_;
  std::array<Vec3, kCount> velocity_;
};

VectorArray restOf(const SheetScene& scene, const GridLayout& g) {
  VectorArray rest(g.storage());
  for (int j = 0; j < g.rows; ++j)
    for (int i = 0; i < g.columns; ++i)
      setPoint(rest, g.at(i, j), Vec3(i * scene.spacing_m(), 0, j * scene.spacing_m()));
  return rest;
}

ElasticGrid makeElastic(const GridLayout& g, const VectorArray& rest,
                        const FasciaSettings& settings) {
  const FloatArray stretch(g.storage(), static_cast<float>(settings.stiffness_N_per_m));
  const FloatArray shear(g.storage(), static_cast<float>(settings.shear_N_per_m));
  return {g, rest, {stretch, stretch, shear, FloatArray(g.storage(), 1.f)}};
}

PointModel makePoints(const SheetScene& scene, const GridLayout& g, const ElasticGrid& elastic) {
  PointModel points;
  for (FloatArray* a : {&points.mass, &points.drag, &points.fat, &points.tissueStiffness,
                        &points.tissueDamping, &points.tissueRestLength, &points.free})
    a->assign(g.storage(), 0.f);
  points.stiffnessBound = elastic.stiffnessBound();
  const double mass_kg = SheetScene::kMass_kg / static_cast<double>(g.pointCount());
  for (int j = 0; j < g.rows; ++j) {
    for (int i = 0; i < g.columns; ++i) {
      points.mass[g.at(i, j)] = static_cast<float>(mass_kg);
      points.drag[g.at(i, j)] = static_cast<float>(mass_kg * kDrag_per_s);
      points.free[g.at(i, j)] = scene.pinned(j) ? 0.f : 1.f;
    }
  }
  return points;
}

std::vector<PointBlock> makeBlocks(const GridLayout& g) {
  std::vector<PointBlock> blocks;
  constexpr auto kWide = static_cast<int>(PointBlock::kCapacity);
  for (int j = 1; j + 1 < g.rows; ++j)
    for (int i = 0; i < g.columns; i += kWide)
      blocks.push_back({g.at(i, j), static_cast<std::uint32_t>(std::min(kWide, g.columns - i))});
  return blocks;
}

class FasciaSheet final : public SheetSolver {
 public:
  FasciaSheet(const SheetScene& scene, const FasciaSettings& settings)
      : layout_{scene.side, scene.side, false},
        rest_(restOf(scene, layout_)),
        topology_(layout_, makeElastic(layout_, rest_, settings), {}),
        points_(makePoints(scene, layout_, topology_.elastic())),
        contact_(makeBlocks(layout_)),
        intervals_(settings.clothSteps > 0 ? 1 : kIntervalsPerFrame),
        position_(layout_.storage()),
        velocity_(layout_.storage()) {
    around_.resize(layout_.storage());
    for (int j = 0; j < layout_.rows; ++j)
      for (int i = 0; i < layout_.columns; ++i)
        setPoint(position_, layout_.at(i, j), scene.start(i, j));
    fillPads(layout_, position_);
    choose(settings);
    meetSpheres();
  }

  int stepsPerFrame() const { return intervals_ * steps_; }

  void advanceFrame() override {
    const StepInputs inputs{&points_,
                            &coefficients_,
                            &around_,
                            nullptr,
                            {0, -static_cast<float>(SheetScene::kGravity_m_per_s2), 0}};
    for (int n = 0; n < intervals_; ++n) {
      stepper_->run(inputs, 0, steps_, position_, velocity_);
      time_s_ += interval_s();
      meetSpheres();
    }
  }

  Vec3 position(int i, int j) const override {
    const std::size_t k = layout_.at(i, j);
    return {position_.x[k], position_.y[k], position_.z[k]};
  }

 private:
  double interval_s() const { return SheetScene::kFrame_s / intervals_; }

  void choose(const FasciaSettings& settings) {
    if (settings.clothSteps > 0) {
      stepper_ = std::make_unique<ClothStepper>(topology_, rest_, points_, FloatArray{});
      steps_ = settings.clothSteps;
    } else {
      stepper_ = topology_.makeStepper();
      steps_ = static_cast<int>(std::ceil(interval_s() / longestStep(points_, kAddedMassShare)));
    }
    prepareStep(points_, response_, interval_s() / steps_, coefficients_);
  }

  // Out of the spheres, and their half spaces for the next interval.
  void meetSpheres() {
    spheres_.moveTo(time_s_);
    const double reach = 2 * maxSpeed_m_per_s_ * interval_s() + 0.02 * SheetScene::kSide_m;
    maxSpeed_m_per_s_ = contact_
                            .project(spheres_, points_, static_cast<float>(reach), 0.f, position_,
                                     velocity_, around_)
                            .maxSpeed_m_per_s;
    fillPads(layout_, position_);
  }

  GridLayout layout_;
  VectorArray rest_;
  GridTopology topology_;
  PointModel points_;
  ContactResponse response_;
  StepCoefficients coefficients_;
  PointSurroundings around_;
  FleshContact contact_;
  std::unique_ptr<SurfaceStepper> stepper_;
  int intervals_;
  VectorArray position_, velocity_;
  Spheres spheres_;
  double time_s_ = 0, maxSpeed_m_per_s_ = 0;
  int steps_ = 1;
};

}  // namespace

std::unique_ptr<SheetSolver> makeFasciaSheet(const SheetScene& scene,
                                             const FasciaSettings& settings, int& stepsPerFrame) {
  auto sheet = std::make_unique<FasciaSheet>(scene, settings);
  stepsPerFrame = sheet->stepsPerFrame();
  return sheet;
}

}  // namespace fascia
