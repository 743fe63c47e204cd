#pragma once

#include <fascia/math/ode/adaptive_stepper.h>
#include <fascia/math/ode/system.h>
#include <fascia/skin/skin.h>

namespace fascia {

// A skin as the solver library sees it: the paper's equation of motion with all its forces, and
// non-penetration after every accepted step (spec L7–L10). Coordinate 3p + c for point p.
class OdeSkin final : public SecondOrderSystem {
 public:
  explicit OdeSkin(const Skin& skin);

  void advance(SkinPoseSource& poses, double start_s, double end_s, FleshContact& contact,
               SkinState& state, SkinStats& stats);

  std::size_t size() const override { return inverseMass_.size(); }
  std::span<const double> inverseMass() const override { return inverseMass_; }
  void addPositionForces(double t_s, std::span<const double> r, std::span<double> f) override;
  void addVelocityForces(double t_s, std::span<const double> r, std::span<const double> v,
                         std::span<double> f) override;
  bool hasVelocityForces() const override { return true; }
  bool forcesDependOnTime() const override { return true; }
  void forceJacobian(double t_s, std::span<const double> r, std::span<const double> v,
                     SparseMatrix& dfdr, SparseMatrix& dfdv) override;
  MatrixKind jacobianKind() const override { return MatrixKind::symmetric; }
  double violation(double t_s, std::span<const double> r) override;
  double project(double t_s, std::span<double> r, std::span<double> v) override;

 private:
  struct Strand;
  Strand strand(std::size_t point, double t_s, std::span<const double> r,
                std::span<const double> v) const;
  void load(std::span<const double> r, VectorArray& out) const;

  const Skin& skin_;
  AdaptiveStepper stepper_;
  std::vector<double> inverseMass_;
  std::vector<std::size_t> storage_;  // of point p
  OdeState ode_;
  VectorArray position_, velocity_, positionBefore_, velocityBefore_, force_;
  SweepScratch scratch_;
  std::vector<Eigen::Triplet<double>> entries_, dampingEntries_;

  // The interval being integrated.
  double start_s_ = 0;
  SkinPoseSource* poses_ = nullptr;
  FleshContact* contact_ = nullptr;
  SkinState* state_ = nullptr;
};

}  // namespace fascia
