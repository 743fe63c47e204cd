#pragma once

#include <memory>
#include <vector>

#include <fascia/skin/grid/prolongation.h>
#include <fascia/skin/skin.h>

namespace fascia {

class OdeSkin;

// Steps one skin: the stabilised leapfrog, by limits, or any integrator of the solver library.
class SkinStepper final : public SkinRun {
 public:
  explicit SkinStepper(const Skin& skin);
  ~SkinStepper() override;

  const Skin& skin() const override { return skin_; }
  void advance(SkinPoseSource& poses, double start_s, double end_s, SkinState& state,
               SkinStats& stats) override;

 private:
  int intervalCount(const SkinPose& end, double span_s, const SkinState& state) const;
  double fallTime() const;
  void begin(const SkinPose& pose, SkinState& state);
  void interval(const SkinPose& pose, double duration_s, SkinState& state, SkinStats& stats);
  void odeInterval(SkinPoseSource& poses, double start_s, double end_s, SkinState& state,
                   SkinStats& stats);
  void rideOnCoarse(const SkinPose& pose, double duration_s, SkinState& state, SkinStats& stats);
  const FloatArray& carryShare(const SkinState& state);
  void startAnew(const SkinPose& pose, SkinState& state, SkinStats& stats) const;
  int chooseStep(double duration_s);
  void leapfrog(int steps, double duration_s, SkinState& state, SkinStats& stats);
  void surround(const SkinPose& pose, double duration_s, SkinState& state, SkinStats& stats);
  void settle(const SkinPose& pose, double duration_s, SkinState& state, SkinStats& stats);
  void takeFixed(VectorArray& position) const;
  void limitSlide(SkinState& state) const;
  void repair(const SkinPose& pose, SkinState& state, SkinStats& stats);

  Skin skin_;  // shares its parts: they live as long as this
  std::unique_ptr<PointPlacer> placer_;
  StepCoefficients coefficients_;
  std::unique_ptr<SurfaceStepper> surface_;
  StretchLimit stretchLimit_;
  std::unique_ptr<SkinContact> contact_;
  SelfContact selfContact_;
  FatPressure fatPressure_;
  VectorArray nextAnchor_, target_;
  VectorArray carried_, nextCarried_;  // where fat presses
  FloatArray wholly_;                  // ones
  std::unique_ptr<OdeSkin> ode_;

  // The grid that this one rides on, if any.
  std::unique_ptr<SkinStepper> coarse_;
  Prolongation prolongation_;
  VectorArray coarseStart_, coarseGridVelocity_, coarseNext_;
};

}  // namespace fascia
