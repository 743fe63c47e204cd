#include "bench/peers/fascia_sheet.h"

#include <array>
#include <cmath>
#include <optional>

#include <fascia/base/error.h>
#include <fascia/field/field.h>
#include <fascia/field/solid.h>
#include <fascia/skin/flesh_contact.h>
#include <fascia/skin/leapfrog.h>
#include <fascia/skin/point_kernels.h>
#include <fascia/skin/prolongation.h>

namespace fascia {
namespace {

// As skins do it: contact is renewed this often within a frame, sheets of more than twice
// kCoarseSide² points ride on one of that size with steps of kRidingStep_s, and steps are as long
// as adding this share to the mass allows.
constexpr int kIntervalsPerFrame = 2;
constexpr int kCoarseSide = 35;
constexpr double kRidingStep_s = 1.0 / 960;
constexpr double kAddedMassShare = 0.02;
constexpr double kShearShare = 0.4;  // shear over stretching stiffness, as in the default skin
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

void setPoint(VectorArray& a, std::size_t k, const Vec3& p) {
  a.x[k] = static_cast<float>(p.x());
  a.y[k] = static_cast<float>(p.y());
  a.z[k] = static_cast<float>(p.z());
}

ElasticGrid makeElastic(const SheetScene& scene, const GridLayout& g, double stiffness_N_per_m) {
  VectorArray rest(g.storage());
  for (int j = 0; j < g.rows; ++j)
    for (int i = 0; i < g.columns; ++i)
      setPoint(rest, g.at(i, j), Vec3(i * scene.spacing_m(), 0, j * scene.spacing_m()));
  const FloatArray stretch(g.storage(), static_cast<float>(stiffness_N_per_m));
  const FloatArray shear(g.storage(), static_cast<float>(kShearShare * stiffness_N_per_m));
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

// One grid of the sheet and its state.
class Grid {
 public:
  Grid(const SheetScene& scene, double stiffness_N_per_m, double step_s)
      : layout_{scene.side, scene.side, false},
        elastic_(makeElastic(scene, layout_, stiffness_N_per_m)),
        points_(makePoints(scene, layout_, elastic_)),
        contact_(makeBlocks(layout_)),
        stepper_(layout_) {
    for (VectorArray* a : {&position, &velocity}) a->resize(layout_.storage());
    around_.resize(layout_.storage());
    for (int j = 0; j < layout_.rows; ++j)
      for (int i = 0; i < layout_.columns; ++i)
        setPoint(position, layout_.at(i, j), scene.start(i, j));
    fillPads(layout_, position);
    const double longest = step_s > 0 ? step_s : longestStep(points_, kAddedMassShare);
    steps_ = static_cast<int>(std::ceil(interval_s() / longest - 1e-6));
    prepareStep(points_, response_, interval_s() / steps_, coefficients_);
  }

  static double interval_s() { return SheetScene::kFrame_s / kIntervalsPerFrame; }
  int stepsPerInterval() const { return steps_; }
  const GridLayout& layout() const { return layout_; }
  const FloatArray& carried() const { return coefficients_.carried; }

  void step() {
    const SweepModel model{&layout_,
                           &elastic_.coefficients(),
                           &points_,
                           &coefficients_,
                           &around_,
                           nullptr,
                           {0, -static_cast<float>(SheetScene::kGravity_m_per_s2), 0}};
    stepper_.run(model, 0, steps_, position, velocity);
  }

  // Out of the spheres, and their half spaces for the next interval.
  void meet(const Field& field) {
    constexpr double kDiagonal_m = SheetScene::kSide_m * 1.41421356;
    const double reach = 2 * maxSpeed_m_per_s_ * interval_s() + 0.01 * kDiagonal_m;
    maxSpeed_m_per_s_ =
        contact_
            .project(field, points_, static_cast<float>(reach), 0.f, position, velocity, around_)
            .maxSpeed_m_per_s;
    fillPads(layout_, position);
  }

  VectorArray position, velocity;

 private:
  GridLayout layout_;
  ElasticGrid elastic_;
  PointModel points_;
  ContactResponse response_;
  StepCoefficients coefficients_;
  PointSurroundings around_;
  FleshContact contact_;
  GridStepper stepper_;
  double maxSpeed_m_per_s_ = 0;
  int steps_ = 1;
};

class FasciaSheet final : public SheetSolver {
 public:
  FasciaSheet(const SheetScene& scene, double stiffness_N_per_m, bool rides)
      : fine_(scene, stiffness_N_per_m, rides ? kRidingStep_s : 0) {
    if (rides) {
      coarse_.emplace(SheetScene{kCoarseSide}, stiffness_N_per_m, 0);
      prolongation_ = Prolongation(coarse_->layout(), fine_.layout());
      coarseWay_.resize(coarse_->layout().storage());
      carrierVelocity_.resize(fine_.layout().storage());
    }
    spheres_.moveTo(0);
    fine_.meet(spheres_);
    if (coarse_) coarse_->meet(spheres_);
  }

  FasciaSteps steps() const {
    FasciaSteps steps{.perFrame = kIntervalsPerFrame * fine_.stepsPerInterval()};
    if (coarse_) steps.coarseSide = kCoarseSide;
    if (coarse_) steps.coarsePerFrame = kIntervalsPerFrame * coarse_->stepsPerInterval();
    return steps;
  }

  void advanceFrame() override {
    for (int n = 0; n < kIntervalsPerFrame; ++n) {
      time_s_ += Grid::interval_s();
      spheres_.moveTo(time_s_);
      if (coarse_) ride();
      fine_.step();
      fine_.meet(spheres_);
    }
  }

  Vec3 position(int i, int j) const override {
    const std::size_t k = fine_.layout().at(i, j);
    return {fine_.position.x[k], fine_.position.y[k], fine_.position.z[k]};
  }

 private:
  // The coarse grid goes first; the fine one takes over the change of its velocity.
  void ride() {
    coarseStart_ = coarse_->position;
    coarse_->step();
    coarse_->meet(spheres_);
    const auto rate = static_cast<float>(1 / Grid::interval_s());
    for (const auto axis : {&VectorArray::x, &VectorArray::y, &VectorArray::z})
      for (std::size_t k = 0; k < coarseStart_.size(); ++k)
        (coarseWay_.*axis)[k] = ((coarse_->position.*axis)[k] - (coarseStart_.*axis)[k]) * rate;
    prolongation_.apply(coarseWay_, nextCarrierVelocity_);
    followCarrier(nextCarrierVelocity_, fine_.carried(), carrierVelocity_, fine_.velocity);
  }

  Grid fine_;
  std::optional<Grid> coarse_;
  Prolongation prolongation_;
  VectorArray coarseStart_, coarseWay_, nextCarrierVelocity_, carrierVelocity_;
  Spheres spheres_;
  double time_s_ = 0;
};

}  // namespace

std::unique_ptr<SheetSolver> makeFasciaSheet(const SheetScene& scene,
                                             const FasciaSettings& settings, FasciaSteps& steps) {
  auto sheet = std::make_unique<FasciaSheet>(
      scene, settings.stiffness_N_per_m, scene.side * scene.side >= 2 * kCoarseSide * kCoarseSide);
  steps = sheet->steps();
  return sheet;
}

}  // namespace fascia
